// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/committer.h"

#include <algorithm>
#include <set>

#include "scheduler/describe_events.h"
#include "scheduler/encode_state.h"
#include "scheduler/make_problems.h"
#include "stages/clustering/host_cluster.h"
#include "stages/clustering/update_clustering.h"
#include "stages/features/assign_camera.h"

namespace psfm {
namespace {

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

Committer::Committer(SessionStore& store, SessionConfig config, const StageOptions& options,
                     SessionState state)
    : store_(&store), config_(std::move(config)), options_(options), state_(std::move(state)) {}

Result<CommitOutput> Committer::handle(const CommitInput& message) {
    CommitOutput output;
    if (failed_) return output;
    const Result<void> done = std::visit([&](const auto& m) { return on(m, output); }, message);
    if (!done.ok()) {
        failed_ = true;
        return done.error();
    }
    advance(output);
    return output;
}

Result<void> Committer::reject(const ExtractedMessage& message, const std::string& reason,
                               std::uint64_t hash, CommitOutput& /*output*/) {
    RejectedPhoto rejected{message.file.name, reason, hash, 0};
    std::error_code unknown_size;
    const auto size = std::filesystem::file_size(message.file.path, unknown_size);
    if (!unknown_size) rejected.file_size = static_cast<std::int64_t>(size);
    if (const auto stored = store_->commit_rejected(rejected); !stored.ok()) return stored;
    ++state_.rejected;
    SessionEvent event;
    event.kind = SessionEvent::Kind::kRejected;
    event.text = reason;
    event.images = {message.file.name};
    events_.push_back(std::move(event));
    ++images_released_;
    return {};
}

Result<void> Committer::on(const ExtractedMessage& message, CommitOutput& output) {
    ++photos_released_;
    ++photos_seen_;
    if (!message.photo->ok()) return reject(message, message.photo->error().message, 0, output);
    const ExtractedPhoto& photo = message.photo->value();
    const std::uint64_t hash = photo.metadata.content_hash;
    if (const auto twin = state_.name_of_content.find(hash); twin != state_.name_of_content.end()) {
        return reject(message,
                      message.file.name + " is a byte-for-byte copy of " + twin->second +
                          ", which is in the session; delete one of the two",
                      hash, output);
    }

    auto accepted = std::make_shared<AcceptedImage>();
    Image& image = accepted->image;
    image.id = static_cast<ImageId>(state_.images.size());
    image.name = message.file.name;
    image.metadata = photo.metadata;
    if (const auto given = config_.given_cameras.find(image.name);
        given != config_.given_cameras.end()) {
        const Camera& camera = given->second.camera;
        if (camera.width != photo.metadata.width || camera.height != photo.metadata.height) {
            return reject(message,
                          message.file.name + " is " + std::to_string(photo.metadata.width) + "x" +
                              std::to_string(photo.metadata.height) +
                              " px, but its given camera is " + std::to_string(camera.width) + "x" +
                              std::to_string(camera.height) + " px; correct cameras.txt",
                          hash, output);
        }
        const auto [entry, added] = state_.camera_of_key.try_emplace(
            "given:" + given->second.key, static_cast<CameraId>(state_.camera_of_key.size()));
        image.camera = entry->second;
        if (added) state_.cameras[image.camera] = camera;
    } else {
        const CameraAssignment assignment =
            assign_camera(config_.camera_sharing, photo.metadata, image.name, state_.camera_of_key);
        state_.camera_of_key.try_emplace(assignment.key, assignment.camera);
        image.camera = assignment.camera;
        if (assignment.added) state_.cameras[image.camera] = *assignment.added;
    }
    accepted->camera = state_.cameras.at(image.camera);
    // Aliased pointers: keypoints and descriptors live as long as the extracted photograph.
    accepted->keypoints = {message.photo, &photo.keypoints};
    accepted->descriptors = {message.photo, &photo.descriptors};
    if (const auto stored =
            store_->commit_image(image, accepted->camera, photo.keypoints, photo.descriptors);
        !stored.ok())
        return stored;

    state_.images.push_back(image);
    state_.keypoints.push_back(std::make_shared<const Keypoints>(photo.keypoints));
    state_.name_of_content.emplace(hash, image.name);
    PendingImage pending;
    pending.report.index = index_of(image.id) + 1;
    pending.report.name = image.name;
    pending.report.extract_ms = message.extract_ms;
    pending.arrival = message.arrival;
    state_.pending[index_of(image.id)] = pending;
    output.accepted.push_back(std::move(accepted));
    return {};
}

Result<void> Committer::on(const ResumedImage& message, CommitOutput& output) {
    PendingImage pending;
    pending.report.index = index_of(message.image->image.id) + 1;
    pending.report.name = message.image->image.name;
    pending.arrival = Clock::now();
    state_.pending[index_of(message.image->image.id)] = pending;
    output.accepted.push_back(message.image);
    return {};
}

Result<void> Committer::on(const VerifiedMessage& message, CommitOutput& /*output*/) {
    if (!message.pairs->ok()) return message.pairs->error();
    const auto start = Clock::now();
    const std::vector<VerifiedPairPtr>& pairs = message.pairs->value();
    const ImageId image = message.image;
    ++state_.verified;
    const std::vector<ImageId> touched =
        select_edges(state_.edges, state_.view_graph, image, pairs, options_.edges);
    const ClusteringEdit edit =
        update_clustering(state_.clustering, state_.view_graph, touched, options_.clustering);
    const std::size_t untouched = state_.clusters.entries().size();
    for (const ClusterChange& change : state_.clusters.apply(edit))
        events_.push_back(describe_change(change));
    state_.counts.solves_skipped += static_cast<std::uint32_t>(
        untouched - std::min(untouched, edit.changed.size() + edit.removed.size()));

    std::set<ClusterId> dirty;
    for (const ClusterMembers& cluster : edit.changed) dirty.insert(cluster.id);
    const std::vector<ClusterId> rehosted = update_hosts(touched, edit);
    dirty.insert(rehosted.begin(), rehosted.end());
    std::vector<StoredCluster> changed;
    changed.reserve(dirty.size());
    for (const ClusterId id : dirty) changed.push_back(stored(state_.clusters.entries().at(id)));
    if (const auto done = store_->commit_pairs(image, pairs, changed, edit.removed); !done.ok())
        return done;
    PendingImage& pending = state_.pending[index_of(image)];
    pending.verified = true;
    pending.report.retrieve_ms = message.retrieve_ms;
    pending.report.verify_ms = message.verify_ms;
    pending.report.cluster_ms = milliseconds_since(start);
    changed_ = true;
    return {};
}

std::vector<ClusterId> Committer::update_hosts(std::span<const ImageId> touched,
                                               const ClusteringEdit& edit) {
    const std::uint32_t mu_min = options_.solve.mu_min;
    std::vector<ImageId> changed(touched.begin(), touched.end());
    std::vector<ClusterId> clusters = edit.removed;
    for (const MovedMembers& moved : edit.moved) {
        changed.insert(changed.end(), moved.members.begin(), moved.members.end());
    }
    for (const ClusterMembers& cluster : edit.changed) {
        clusters.push_back(cluster.id);
        // A cluster that has just become large enough was in parts below mu_min before.
        const bool is_new_host = state_.clusters.entries().at(cluster.id).revision == 0;
        if (cluster.members.size() < mu_min || is_new_host) {
            changed.insert(changed.end(), cluster.members.begin(), cluster.members.end());
        }
    }
    const std::vector<ImageId> guests = state_.clusters.guests_of(clusters);
    changed.insert(changed.end(), guests.begin(), guests.end());
    std::vector<std::pair<ImageId, std::optional<ClusterId>>> hosts;
    for (const ImageId image :
         images_to_host_again(state_.view_graph, state_.clustering, changed, mu_min)) {
        hosts.emplace_back(image,
                           host_cluster(state_.view_graph, state_.clustering, image, mu_min));
    }
    return state_.clusters.set_hosts(hosts);
}

Result<void> Committer::on(const SolvedMessage& message, CommitOutput& /*output*/) {
    ClusterSolution solution;
    if (message.solution->ok()) {
        solution = message.solution->value();
    } else {
        // A failed solve leaves its images waiting; the next change of the cluster tries again.
        solution.cluster = message.problem->cluster;
        solution.topology = message.problem->topology;
        solution.model = message.problem->recycled ? message.problem->recycled
                                                   : std::make_shared<const Reconstruction>();
        solution.state = message.problem->recycled_state;
    }
    const SolveStatistics& statistics = solution.statistics;
    switch (statistics.kind) {
        case SolveKind::kNew:
            ++state_.counts.solves_new;
            break;
        case SolveKind::kExtend:
            ++state_.counts.solves_extend;
            break;
        case SolveKind::kSettle:
            ++state_.counts.solves_settle;
            break;
        case SolveKind::kTooSmall:
            break;
    }
    for (auto& [index, pending] : state_.pending) {
        const auto in_problem = std::ranges::lower_bound(
            message.problem->images, static_cast<ImageId>(index), {}, &ClusterImage::id);
        if (in_problem != message.problem->images.end() && index_of(in_problem->id) == index)
            pending.report.solve_ms += statistics.milliseconds;
    }
    const ClusterEntry* entry = state_.clusters.finish(*message.problem, solution);
    events_.push_back(
        describe_solve(*message.problem, *message.solution, solution, entry != nullptr));
    changed_ = true;
    if (entry == nullptr) return {};
    StoredSolution stored_solution;
    stored_solution.cluster = entry->id;
    stored_solution.revision = entry->revision;
    stored_solution.model = entry->model;
    stored_solution.state_json = encode_solve_state({solution.state, entry->settled});
    return store_->commit_solution(stored_solution, stored(*entry));
}

Result<void> Committer::on(const EndOfPhotos& message, CommitOutput& /*output*/) {
    photos_expected_ = message.photos;
    return {};
}

Result<void> Committer::on(const MergedMessage& message, CommitOutput& output) {
    merging_ = false;
    if (!message.result->ok()) return message.result->error();
    const MergeResult& merged = message.result->value();
    auto scene = std::make_shared<Scene>();
    scene->version = state_.scene->version + 1;
    scene->image_count = state_.verified;
    scene->effective_clusters = merged.effective_clusters;
    StoredSceneVersion stored_version;
    for (const MergeCluster& cluster : message.problem->clusters) {
        const auto entry = state_.clusters.entries().find(cluster.id);
        // Gone or solved again since: the next merge, which is due already, shows it.
        if (entry == state_.clusters.entries().end() || entry->second.model != cluster.model)
            continue;
        const auto placement =
            std::ranges::lower_bound(merged.placements, cluster.id, {}, &ClusterPlacement::id);
        auto shown = std::make_shared<SceneCluster>();
        shown->id = cluster.id;
        shown->revision = cluster.revision;
        shown->members = state_.clusters.images_of(entry->second);
        shown->model = cluster.model;
        if (cluster.model && places_others_than(*cluster.model, shown->members)) {
            // Guests that have a cluster of their own by now; the next solve leaves them out.
            shown->model = std::make_shared<const Reconstruction>(
                restricted_to(*cluster.model, shown->members));
        }
        shown->world_from_cluster = placement->world_from_cluster;
        shown->effective_cluster = placement->effective_cluster;
        stored_version.placements.push_back({shown->id, shown->revision, shown->members,
                                             shown->world_from_cluster, shown->effective_cluster});
        scene->clusters.push_back(std::move(shown));
    }
    count(*scene);
    stored_version.version = scene->version;
    stored_version.image_count = scene->image_count;
    stored_version.effective_clusters = scene->effective_clusters;
    stored_version.summary_json =
        encode_summary({state_.counts, waiting_images(state_, options_.solve.mu_min)});
    if (const auto stored = store_->commit_scene(stored_version); !stored.ok()) return stored;
    state_.constraints = merged.constraints;
    state_.scene = scene;
    PublishMessage publish;
    publish.scene = scene;
    publish.counts = state_.counts;
    report_published(*message.problem, message.merge_ms, publish);
    output.publish = std::move(publish);
    return {};
}

void Committer::count(const Scene& scene) {
    SessionCounts& counts = state_.counts;
    counts.images = static_cast<std::uint32_t>(state_.images.size());
    counts.placed = static_cast<std::uint32_t>(placed_count(scene));
    counts.waiting = counts.images - counts.placed;
    counts.rejected = state_.rejected;
    counts.clusters =
        static_cast<std::uint32_t>(std::ranges::count_if(scene.clusters, [](const auto& cluster) {
            return cluster->model && !cluster->model->empty();
        }));
    counts.effective_clusters = scene.effective_clusters;
    counts.version = scene.version;
    counts.solves_coalesced = state_.clusters.coalesced();
}

void Committer::report_published(const MergeProblem& problem, double merge_ms,
                                 PublishMessage& publish) {
    for (auto& [index, pending] : state_.pending) {
        if (pending.published || !pending.verified) continue;
        const ClusterEntry& entry = state_.clusters.of(static_cast<ImageId>(index));
        const auto merged =
            std::ranges::lower_bound(problem.clusters, entry.id, {}, &MergeCluster::id);
        const bool shown = merged != problem.clusters.end() && merged->id == entry.id &&
                           merged->model == entry.model;
        if (!shown || entry.phase != ClusterPhase::kClean) continue;
        pending.published = true;
        pending.report.merge_ms = merge_ms;
        pending.report.latency_ms = milliseconds_since(pending.arrival);
        ++images_released_;
    }
    // Reports leave in order of arrival: one that is ready waits for those before it.
    while (!state_.pending.empty() && state_.pending.begin()->second.published) {
        publish.images.push_back(state_.pending.begin()->second.report);
        state_.pending.erase(state_.pending.begin());
    }
}

void Committer::advance(CommitOutput& output) {
    const bool all_verified =
        std::ranges::all_of(state_.pending, [](const auto& p) { return p.second.verified; });
    const bool ended = photos_expected_ == photos_seen_;
    const bool hold = config_.batch && !(ended && all_verified);
    if (!hold) {
        for (const ClusterEntry* entry : state_.clusters.take_dirty())
            output.solves.push_back({make_cluster_problem(state_, config_, *entry, false)});
    }
    // Settling begins once everything is published, so that what it starts from does not depend on
    // timing.
    const bool all_published =
        state_.pending.empty() && !state_.clusters.busy() && !changed_ && !merging_;
    if (ended && all_published && !settled_) {
        settled_ = true;
        for (const ClusterEntry* entry : state_.clusters.take_unsettled())
            output.solves.push_back({make_cluster_problem(state_, config_, *entry, true)});
    }
    // Deterministic sessions publish when everything is solved; others as soon as there is
    // something new.
    const bool due =
        changed_ && !merging_ && !hold && (!config_.deterministic || !state_.clusters.busy());
    if (due) {
        changed_ = false;
        merging_ = true;
        output.merge = MergeMessage{make_merge_problem(state_)};
    }
    if (!output.publish && (!events_.empty() || photos_released_ > 0 || images_released_ > 0))
        output.publish.emplace();
    if (output.publish) {
        output.publish->events = std::move(events_);
        events_.clear();
        output.publish->photos_released = std::exchange(photos_released_, 0);
        output.publish->images_released = std::exchange(images_released_, 0);
        if (!output.publish->scene) output.publish->counts = state_.counts;
    }
}

StoredCluster Committer::stored(const ClusterEntry& entry) const {
    StoredCluster cluster;
    cluster.id = entry.id;
    cluster.members = entry.members;
    cluster.topology = entry.topology;
    cluster.solved_topology = entry.solved_topology;
    cluster.revision = entry.revision;
    cluster.anew_topology = entry.anew_topology;
    return cluster;
}

}  // namespace psfm
