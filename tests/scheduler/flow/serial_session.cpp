// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/scheduler/flow/serial_session.h"

#include <gtest/gtest.h>

#include <deque>
#include <iterator>
#include <utility>

#include "stages/merge/run_merge.h"
#include "stages/reconstruction/solve/solve_cluster.h"

namespace psfm::test {
namespace {

SessionConfig config_of(const synthetic::SyntheticScene& scene, bool deterministic) {
    SessionConfig config;
    config.deterministic = deterministic;
    config.fix_intrinsics = true;
    for (std::size_t i = 0; i < scene.images.size(); ++i) {
        const CameraId camera = scene.images[i].camera;
        config.given_cameras[std::to_string(i)] = {std::to_string(index_of(camera)),
                                                   scene.cameras.at(camera)};
    }
    return config;
}

ExtractedMessage extracted(const synthetic::SyntheticScene& scene, std::size_t index,
                           std::uint64_t sequence) {
    const synthetic::SceneImage& image = scene.images[index];
    const Camera& camera = scene.cameras.at(image.camera);
    ExtractedPhoto photo;
    photo.metadata.width = camera.width;
    photo.metadata.height = camera.height;
    photo.metadata.content_hash = 1000 + index;
    photo.keypoints = image.keypoints;
    photo.descriptors.values.resize(image.keypoints.size() * Descriptors::kSize);
    return {sequence,
            {"", std::to_string(index)},
            Clock::now(),
            std::make_shared<const Result<ExtractedPhoto>>(std::move(photo)),
            0.0};
}

}  // namespace

std::unique_ptr<SessionStore> open_store(const testing::TemporaryFolder& folder) {
    auto store = SessionStore::open(folder.session(), {});
    EXPECT_TRUE(store.ok());
    return *std::move(store);
}

SerialSession::SerialSession(SessionStore& store, const synthetic::SyntheticScene& scene,
                             const std::vector<VerifiedPairPtr>& pairs, bool deterministic,
                             const ClusteringOptions& clustering, const SolvePolicy& policy,
                             const CommitterPace& pace)
    : scene_(&scene), pairs_(&pairs) {
    const SessionConfig config = config_of(scene, deterministic);
    options_ = *stage_options(config);
    options_.clustering = clustering;
    options_.solve.policy = policy;
    auto restored = restore_session(store, config, options_);
    EXPECT_TRUE(restored.ok());
    std::vector<CommitInput> messages{CatchUp{}};
    for (const AcceptedImagePtr& image : restored->unverified)
        messages.emplace_back(ResumedImage{image});
    committer_ =
        std::make_unique<Committer>(store, config, options_, std::move(restored->state), pace);
    EXPECT_TRUE(run(std::move(messages), kAll));
}

CommitInput SerialSession::verified(ImageId image) const {
    std::vector<VerifiedPairPtr> own;
    std::ranges::copy_if(*pairs_, std::back_inserter(own),
                         [&](const VerifiedPairPtr& pair) { return pair->pair.second == image; });
    return VerifiedMessage{
        image, std::make_shared<const Result<std::vector<VerifiedPairPtr>>>(std::move(own)), 0.0,
        0.0};
}

CommitInput SerialSession::solved(const SolveMessage& solve) const {
    Result<ClusterSolution> solution = Error{ErrorCode::kInternal, "not enough memory"};
    if (!fails_solves_) solution = solve_cluster(*solve.problem, options_.solve, nullptr);
    return SolvedMessage{solve.problem,
                         std::make_shared<const Result<ClusterSolution>>(std::move(solution))};
}

CommitInput SerialSession::merged(const MergeMessage& merge) {
    using Outcome = MergedMessage::Outcome;
    auto result = run_merge(*merge.problem, options_.merge);
    EXPECT_TRUE(result.ok());
    auto adoptions = find_adoptions(*merge.problem, *result, *merge.unplaced, options_.solve);
    return MergedMessage{
        merge.problem, merge.unplaced,
        std::make_shared<const Result<Outcome>>(Outcome{*std::move(result), std::move(adoptions)}),
        merge_ms_};
}

void SerialSession::release_merge() {
    ASSERT_TRUE(held_merge_.has_value());
    const MergeMessage merge = *std::exchange(held_merge_, std::nullopt);
    EXPECT_TRUE(run({merged(merge)}, kAll));
}

void SerialSession::release_solves(bool last_first) {
    holds_solves_ = false;
    if (last_first) std::ranges::reverse(held_);
    std::vector<CommitInput> messages;
    for (const SolveMessage& solve : held_) messages.push_back(solved(solve));
    held_.clear();
    EXPECT_TRUE(run(std::move(messages), kAll));
}

void SerialSession::release_held() {
    std::vector<CommitInput> messages;
    for (const SolveMessage& solve : std::exchange(held_, {})) messages.push_back(solved(solve));
    EXPECT_TRUE(run(std::move(messages), kAll));
}

void SerialSession::release_showing_two_places(ClusterId cluster, std::size_t parts) {
    std::vector<CommitInput> messages;
    for (const SolveMessage& solve : std::exchange(held_, {})) {
        auto solution = solve_cluster(*solve.problem, options_.solve, nullptr);
        if (solution.ok() && solve.problem->cluster == cluster) {
            const std::vector<RegisteredImage>& images = solution->model->images;
            solution->places.resize(2);
            for (std::size_t i = 0; i < images.size(); ++i)
                solution->places[parts * i < images.size() ? 0 : 1].push_back(images[i].image);
        }
        messages.emplace_back(SolvedMessage{
            solve.problem, std::make_shared<const Result<ClusterSolution>>(std::move(solution))});
    }
    EXPECT_TRUE(run(std::move(messages), kAll));
}

bool SerialSession::run(std::vector<CommitInput> messages, std::size_t at_most) {
    std::deque<CommitInput> queue(std::make_move_iterator(messages.begin()),
                                  std::make_move_iterator(messages.end()));
    for (; !queue.empty(); queue.pop_front()) {
        if (at_most-- == 0) return false;
        auto output = committer_->handle(queue.front());
        EXPECT_TRUE(output.ok()) << output.error().message;
        if (!output.ok()) return false;
        for (const AcceptedImagePtr& accepted : output->accepted)
            queue.push_back(verified(accepted->image.id));
        for (const SolveMessage& solve : output->solves) {
            if (holds_solves_) {
                held_.push_back(solve);
            } else {
                queue.push_back(solved(solve));
            }
        }
        if (output->merge) {
            if (holds_merges_) {
                held_merge_ = output->merge;
            } else {
                queue.push_back(merged(*output->merge));
            }
        }
        if (!output->publish) continue;
        released_ += output->publish->images_released;
        std::ranges::move(output->publish->events, std::back_inserter(events_));
        for (const ImageReport& report : output->publish->images) {
            reported_.push_back(report.index);
            placed_when_reported_.push_back(output->publish->counts.placed);
        }
    }
    return true;
}

bool SerialSession::add_image(std::size_t messages) {
    const std::uint64_t sequence = photos_++;
    return run({extracted(*scene_, committer_->state().photographs.images.size(), sequence)},
               messages);
}

void SerialSession::idle() {
    EXPECT_TRUE(run({SourceIdle{photos_}}, kAll));
}

void SerialSession::end() {
    EXPECT_TRUE(run({EndOfPhotos{photos_}}, kAll));
}

}  // namespace psfm::test
