// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/committer.h"

#include <algorithm>
#include <utility>

#include "graph/sorted_unique.h"
#include "scheduler/flow/make_problems.h"
#include "scheduler/flow/version_due.h"
#include "scheduler/report/event_log.h"

namespace psfm {

Committer::Committer(SessionStore& store, SessionConfig config, const StageOptions& options,
                     SessionState state, const CommitterPace& pace)
    : store_(&store),
      config_(std::move(config)),
      options_(options),
      state_(std::move(state)),
      reports_(config_, state_, outbox_),
      intake_(store, config_, options_, state_, reports_, outbox_),
      keeper_(store, options_, state_, outbox_),
      pace_(pace),
      coalesced_before_(state_.counts.solves_coalesced) {
    state_.photographs.keypoints.set_budget(pace.idle_bytes);
    state_.models.set_budget(pace.idle_bytes);
}

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

Result<void> Committer::on(const VerifiedMessage& message, CommitOutput& /*output*/) {
    if (!message.pairs->ok()) return message.pairs->error();
    const auto start = Clock::now();
    const std::vector<VerifiedPairPtr>& pairs = message.pairs->value();
    state_.concluding = false;
    const auto edit = keeper_.add_image(message.image, pairs);
    if (!edit.ok()) return edit.error();
    if (const auto done = store_->commit_pairs(message.image, pairs, edit->changed, edit->removed);
        !done.ok())
        return done.error();
    store_->give_up_cache(bytes_of(pairs));
    reports_.verify(message, milliseconds_since(start));
    changed_ = true;
    return {};
}

Result<void> Committer::on(const SourceIdle& message, CommitOutput& /*output*/) {
    photos_before_idle_ = message.photos;
    if (message.for_long) photos_before_rest_ = message.photos;
    return {};
}

Result<void> Committer::on(const EndOfPhotos& message, CommitOutput& /*output*/) {
    photos_before_idle_ = message.photos;
    photos_expected_ = message.photos;
    return {};
}

Result<std::vector<UnplacedImage>> Committer::images_to_adopt() {
    std::vector<UnplacedImage> unplaced = unplaced_images(state_, config_);
    std::vector<ImageId> missing;
    for (const UnplacedImage& image : unplaced) {
        if (!image.keypoints) missing.push_back(image.id);
    }
    if (missing.empty()) return unplaced;
    const auto read = state_.photographs.keypoints.use(missing, *store_);
    if (!read.ok()) return read.error();
    for (UnplacedImage& image : unplaced)
        image.keypoints = state_.photographs.keypoints[index_of(image.id)];
    return unplaced;
}

Result<MergeMessage> Committer::problem_of_merge() {
    const std::shared_ptr<MergeProblem> problem =
        make_merge_problem(state_, config_, options_.merge);
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
    const bool all_verified = reports_.all_verified();
    const bool ended = photos_expected_ == photos_seen_;
    const bool hold = config_.batch && !(ended && all_verified);
    if (const auto settled = go_on_settling(output); !settled.ok()) return settled.error();
    if (!hold) {
        const auto started = start_solves(state_.clusters.take_dirty(), /*settle=*/false, output);
        if (!started.ok()) return started.error();
    }
    // Settling begins once everything is published, so that what it starts from does not depend on
    // timing; what an earlier process was settling ends as one version, as it would have there.
    const bool at_rest = reports_.empty() && !state_.clusters.busy() && !merging_;
    const bool ends_for_now =
        photos_before_rest_ == photos_seen_ && !hold && !config_.deterministic;
    if (at_rest && ((settle_first_ && !hold) || ((ended || ends_for_now) && !changed_))) {
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
    // A batch catches up with its last image.
    if (catching_up_ && (caught_up || hold || !config_.deterministic)) {
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
    if (pace_.image_tokens == nullptr || photos_before_idle_ == photos_seen_) return false;
    // Those that this message gives back are not there yet.
    return outbox_.images_released > 0 || pace_.image_tokens->has_free();
}

}  // namespace psfm
