// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/committer.h"

#include <algorithm>
#include <span>
#include <utility>

#include "graph/sorted_unique.h"
#include "scheduler/flow/make_problems.h"
#include "scheduler/flow/version_due.h"
#include "scheduler/report/event_log.h"
#include "scheduler/session/known_files.h"
#include "scheduler/session/remove_images.h"
#include "stages/clustering/keep_apart.h"
#include "stages/features/cameras/assign_camera.h"

namespace psfm {
namespace {

/// Guard: bounds the images that wait for their version without holding a token: this part of all.
/// Raised: more versions, so that the cost of an image grows with the session; lowered: fewer and
/// later ones while images stream in faster than they are solved.
constexpr std::uint32_t kImagesPerWaiting = 25;

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
    if (const auto advanced = advance(output); !advanced.ok()) {
        failed_ = true;
        return advanced.error();
    }
    return output;
}

void Committer::tell_of_photo(SessionEvent::Kind kind, const std::string& name,
                              const std::string& text) {
    SessionEvent event;
    event.kind = kind;
    event.text = text;
    event.images = {name};
    events_.push_back(std::move(event));
}

Result<void> Committer::reject(const ExtractedMessage& message, const std::string& reason,
                               std::uint64_t hash, const std::optional<FileStamp>& stamp) {
    RejectedPhoto rejected{message.file.name, reason, hash, -1};
    if (stamp) {
        rejected.file_size = stamp->size;
        rejected.file_time = stamp->modified_ns;
    }
    if (const auto stored = store_->commit_rejected(rejected); !stored.ok()) return stored.error();
    state_.rejected.insert(message.file.name);
    tell_of_photo(SessionEvent::Kind::kRejected, message.file.name, reason);
    ++images_released_;
    return {};
}

void Committer::pass_over(const ExtractedMessage& message) {
    ++images_released_;
    const std::string& name = message.file.name;
    if (!message.photo->ok()) return;  // it was read when it was accepted
    const auto twin = state_.image_of_content.find(message.photo->value().metadata.content_hash);
    if (twin != state_.image_of_content.end() && state_.images[index_of(twin->second)].name == name)
        return;
    tell_of_photo(SessionEvent::Kind::kRejected, name,
                  name +
                      " is another photograph than the one of that name which is in the session; "
                      "give it a name of its own");
}

std::optional<CameraId> Committer::camera_of(const Image& image) {
    const CameraId next{state_.cameras.empty() ? 0 : index_of(state_.cameras.rbegin()->first) + 1};
    const auto given = config_.given_cameras.find(image.name);
    if (given == config_.given_cameras.end()) {
        const CameraAssignment assignment =
            assign_camera(config_.camera_sharing, image.metadata, image.name, state_.camera_of_key,
                          next, options_.features.unknown_focal);
        state_.camera_of_key.try_emplace(assignment.key, assignment.camera);
        if (assignment.added) state_.cameras[assignment.camera] = *assignment.added;
        return assignment.camera;
    }
    const Camera& camera = given->second.camera;
    if (camera.width != image.metadata.width || camera.height != image.metadata.height)
        return std::nullopt;
    const auto [entry, added] =
        state_.camera_of_key.try_emplace("given:" + given->second.key, next);
    if (added) state_.cameras[next] = camera;
    return entry->second;
}

Result<void> Committer::on(const ExtractedMessage& message, CommitOutput& output) {
    ++photos_released_;
    ++photos_seen_;
    const std::string& name = message.file.name;
    if (state_.names.contains(name)) {
        pass_over(message);
        return {};
    }
    if (!message.photo->ok()) {
        // What the system refuses now it may give the next time.
        const Error& error = message.photo->error();
        const bool is_its_content = error.code == ErrorCode::kUnreadable;
        return reject(message, error.message, 0, is_its_content ? message.stamp : std::nullopt);
    }
    const ExtractedPhoto& photo = message.photo->value();
    const std::uint64_t hash = photo.metadata.content_hash;
    if (state_.removed_content.contains(hash))
        return reject(message, removal_reason(name), hash, message.stamp);
    if (const auto twin = state_.image_of_content.find(hash); twin != state_.image_of_content.end())
        return meet_twin(message, twin->second);
    if (const std::string copy = small_copy_of_known(name, photo); !copy.empty())
        return reject(message, copy, hash, message.stamp);

    auto accepted = std::make_shared<AcceptedImage>();
    Image& image = accepted->image;
    image.id = static_cast<ImageId>(state_.images.size());
    image.name = name;
    image.metadata = photo.metadata;
    const auto camera = camera_of(image);
    if (!camera) {
        const Camera& given = config_.given_cameras.at(name).camera;
        return reject(message,
                      name + " is " + std::to_string(photo.metadata.width) + "x" +
                          std::to_string(photo.metadata.height) + " px, but its given camera is " +
                          std::to_string(given.width) + "x" + std::to_string(given.height) +
                          " px; correct cameras.txt",
                      hash, std::nullopt);
    }
    image.camera = *camera;
    accepted->camera = state_.cameras.at(image.camera);
    ImageSource source;
    source.signature = photo.signature;
    source.mask_hash = photo.mask_hash;
    if (message.stamp) source.file = file_of(message.file, *message.stamp);
    // Aliased pointers: keypoints and descriptors live as long as the extracted photograph.
    accepted->keypoints = {message.photo, &photo.keypoints};
    accepted->descriptors = {message.photo, &photo.descriptors};
    accepted->view_graph = state_.view_graph;
    if (const auto stored = store_->commit_image(image, accepted->camera, photo.keypoints,
                                                 photo.descriptors, source);
        !stored.ok())
        return stored.error();

    state_.images.push_back(image);
    state_.sources.push_back(std::move(source));
    state_.keypoints.push_back(std::make_shared<const Keypoints>(photo.keypoints));
    state_.image_of_content.emplace(hash, image.id);
    state_.names.insert(image.name);
    state_.rejected.erase(image.name);
    PendingImage pending;
    pending.report.index = index_of(image.id) + 1;
    pending.report.name = image.name;
    pending.report.extract_ms = message.extract_ms;
    pending.arrival = message.arrival;
    state_.pending[index_of(image.id)] = pending;
    output.accepted.push_back(std::move(accepted));
    for (const std::string& remark : photo.remarks)
        tell_of_photo(SessionEvent::Kind::kRemark, name, remark);
    tell_of_small_copies(image.id);
    return {};
}

void Committer::release_early(PendingImage& verified) {
    if (config_.deterministic || !verified.admitted) return;
    const auto waiting = std::ranges::count_if(
        state_.pending, [](const auto& p) { return p.second.verified && !p.second.admitted; });
    if (static_cast<std::uint32_t>(waiting) >= state_.verified / kImagesPerWaiting) return;
    verified.admitted = false;
    ++images_released_;
}

Result<void> Committer::on(const SourceIdle& message, CommitOutput& /*output*/) {
    photos_before_idle_ = message.photos;
    return {};
}

Result<void> Committer::on(const EndOfPhotos& message, CommitOutput& /*output*/) {
    photos_before_idle_ = message.photos;
    photos_expected_ = message.photos;
    return {};
}

void Committer::tell(SessionEvent event) {
    state_.past_events.push_back({state_.verified, name_of(event.kind), event.text});
    if (state_.past_events.size() > SessionState::kPastEvents) state_.past_events.pop_front();
    events_.push_back(std::move(event));
}

Result<std::vector<UnplacedImage>> Committer::images_to_adopt() {
    std::vector<UnplacedImage> unplaced = unplaced_images(state_, config_);
    std::vector<ImageId> missing;
    for (const UnplacedImage& image : unplaced) {
        if (!image.keypoints) missing.push_back(image.id);
    }
    if (missing.empty()) return unplaced;
    const auto read = state_.keypoints.use(missing, *store_);
    if (!read.ok()) return read.error();
    for (UnplacedImage& image : unplaced) image.keypoints = state_.keypoints[index_of(image.id)];
    return unplaced;
}

Result<MergeMessage> Committer::problem_of_merge() {
    const std::shared_ptr<MergeProblem> problem = make_merge_problem(state_);
    auto unplaced = images_to_adopt();
    if (!unplaced.ok()) return unplaced.error();
    std::vector<ClusterId> seen = clusters_to_look_into(*problem);
    for (const UnplacedImage& image : *unplaced) {
        for (const UnplacedImage::Edge& edge : image.edges) seen.push_back(edge.cluster);
    }
    sort_unique(seen);
    const auto awake = state_.models.use(seen, state_.clusters, *store_);
    if (!awake.ok()) return awake.error();
    for (MergeCluster& cluster : problem->clusters)
        cluster.model = state_.clusters.entries().at(cluster.id).model;
    return MergeMessage{problem,
                        std::make_shared<std::vector<UnplacedImage>>(*std::move(unplaced))};
}

Result<void> Committer::advance(CommitOutput& output) {
    const bool all_verified =
        std::ranges::all_of(state_.pending, [](const auto& p) { return p.second.verified; });
    const bool ended = photos_expected_ == photos_seen_;
    const bool hold = config_.batch && !(ended && all_verified);
    if (const auto settled = go_on_settling(output); !settled.ok()) return settled.error();
    if (!hold) {
        const auto started = start_solves(state_.clusters.take_dirty(), /*settle=*/false, output);
        if (!started.ok()) return started.error();
    }
    // Settling begins once everything is published, so that what it starts from does not depend on
    // timing; what an earlier process was settling ends as one version, as it would have there.
    const bool at_rest = state_.pending.empty() && !state_.clusters.busy() && !merging_;
    if (at_rest && ((settle_first_ && !hold) || (ended && !changed_))) {
        if (const auto concluded = conclude(output); !concluded.ok()) return concluded.error();
    }
    const VersionMoment moment{.changed = changed_,
                               .merging = merging_,
                               .held = hold,
                               .deterministic = config_.deterministic,
                               .busy = state_.clusters.busy(),
                               .all_verified = all_verified,
                               .more_to_come = more_to_come(),
                               .now = Clock::now(),
                               .not_before = next_version_};
    if (version_is_due(moment)) {
        changed_ = false;
        merging_ = true;
        auto merge = problem_of_merge();
        if (!merge.ok()) return merge.error();
        output.merge = *std::move(merge);
    }
    const bool caught_up = !state_.clusters.busy() && !changed_ && !merging_;
    if (catching_up_ && (caught_up || !config_.deterministic)) {
        catching_up_ = false;
        ++images_released_;
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
    return {};
}

bool Committer::more_to_come() const {
    if (image_tokens_ == nullptr || photos_before_idle_ == photos_seen_) return false;
    // Those that this message gives back are not there yet.
    return images_released_ > 0 || image_tokens_->has_free();
}

StoredCluster Committer::stored(const ClusterEntry& entry) const {
    StoredCluster cluster;
    cluster.id = entry.id;
    cluster.members = entry.members;
    cluster.topology = entry.topology;
    cluster.solved_topology = entry.solved_topology;
    cluster.revision = entry.revision;
    cluster.transfer_topology = entry.transfer_topology;
    cluster.adopted = state_.clusters.adopted_by(entry);
    cluster.apart = apart_pairs_of(state_.edges, entry.members);
    for (const auto& [source, revision] : entry.brought) {
        if (source != entry.id) cluster.recycled.push_back({source, revision});
    }
    return cluster;
}

}  // namespace psfm
