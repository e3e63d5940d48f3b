// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/committer.h"

#include <algorithm>
#include <utility>

#include "graph/sorted_unique.h"
#include "scheduler/flow/make_problems.h"
#include "scheduler/flow/version_due.h"
#include "scheduler/report/event_log.h"
#include "stages/clustering/keep_apart.h"

namespace psfm {
namespace {

/// Guard: bounds the images that wait for their version without holding a token: this part of all.
/// Raised: more versions, so that the cost of an image grows with the session; lowered: fewer and
/// later ones while images stream in faster than they are solved.
constexpr std::uint32_t kImagesPerWaiting = 25;

}  // namespace

Committer::Committer(SessionStore& store, SessionConfig config, const StageOptions& options,
                     SessionState state)
    : store_(&store),
      config_(std::move(config)),
      options_(options),
      state_(std::move(state)),
      intake_(store, config_, options_, state_, outbox_) {}

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

Result<void> Committer::on(const ExtractedMessage& message, CommitOutput& output) {
    ++outbox_.photos_released;
    ++photos_seen_;
    auto taken = intake_.take(message);
    if (!taken.ok()) return taken.error();
    if (*taken) output.accepted.push_back(*std::move(taken));
    return {};
}

void Committer::release_early(PendingImage& verified) {
    if (config_.deterministic || !verified.admitted) return;
    const auto waiting = std::ranges::count_if(
        state_.pending, [](const auto& p) { return p.second.verified && !p.second.admitted; });
    if (static_cast<std::uint32_t>(waiting) >= state_.verified / kImagesPerWaiting) return;
    verified.admitted = false;
    ++outbox_.images_released;
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
    outbox_.events.push_back(std::move(event));
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
        cluster.model = state_.clusters.entries().at(cluster.id).published.model;
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
        ++outbox_.images_released;
    }
    if (!output.publish && !outbox_.empty()) output.publish.emplace();
    if (output.publish) {
        outbox_.empty_into(*output.publish);
        if (!output.publish->scene) output.publish->counts = state_.counts;
    }
    return {};
}

bool Committer::more_to_come() const {
    if (image_tokens_ == nullptr || photos_before_idle_ == photos_seen_) return false;
    // Those that this message gives back are not there yet.
    return outbox_.images_released > 0 || image_tokens_->has_free();
}

StoredCluster Committer::stored(const ClusterEntry& entry) const {
    StoredCluster cluster;
    cluster.id = entry.id;
    cluster.members = entry.membership.members;
    cluster.topology = entry.membership.topology;
    cluster.solved_topology = entry.published.topology;
    cluster.revision = entry.published.revision;
    cluster.transfer_topology = entry.material.transfer_topology;
    cluster.adopted = state_.clusters.adopted_by(entry);
    cluster.apart = apart_pairs_of(state_.edges, entry.membership.members);
    for (const auto& [source, revision] : entry.material.brought) {
        if (source != entry.id) cluster.recycled.push_back({source, revision});
    }
    return cluster;
}

}  // namespace psfm
