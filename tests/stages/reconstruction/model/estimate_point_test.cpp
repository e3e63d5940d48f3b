// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/estimate_point.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

class EstimatePointTest : public testing::Test {
  protected:
    synthetic::SyntheticScene scene = synthetic::make_scene(synthetic::ring_around_sphere(10), 3);
    std::vector<VerifiedPairPtr> pairs = synthetic::make_verified_pairs(scene);
    ClusterProblem problem = problem_of(scene, pairs);
    CorrespondenceGraph matches = [&] {
        std::vector<ImageId> ids;
        std::vector<std::uint32_t> counts;
        for (const ClusterImage& image : problem.images) {
            ids.push_back(image.id);
            counts.push_back(static_cast<std::uint32_t>(image.keypoints->size()));
        }
        return CorrespondenceGraph(ids, counts, pairs);
    }();
    WorkingModel model{problem, matches};

    void SetUp() override {
        for (std::uint32_t i = 0; i < scene.images.size(); ++i)
            model.set_pose(i, scene.images[i].cam_from_world);
    }
};

TEST_F(EstimatePointTest, LeavesOutWhatDoesNotAgree) {
    const auto tracks = synthetic::tracks(scene);
    const auto is_long = [](const auto& track) { return track.size() >= 4; };
    const auto first = std::ranges::find_if(tracks, is_long);
    const auto second = std::find_if(first + 1, tracks.end(), is_long);
    ASSERT_NE(second, tracks.end());
    std::vector<WorkingModel::Feature> candidates;
    for (const Observation& o : *first) candidates.push_back({index_of(o.image), o.feature});
    candidates.push_back({index_of(second->front().image), second->front().feature});
    const auto estimated = estimate_point(model, candidates, TrackOptions{});
    ASSERT_TRUE(estimated.has_value());
    EXPECT_EQ(estimated->inliers.size(), first->size());
    const std::uint32_t true_point =
        scene.images[index_of(first->front().image)].feature_point[first->front().feature];
    EXPECT_LT((estimated->position - scene.points[true_point].position).norm(), 1e-3);
}

TEST_F(EstimatePointTest, NeedsParallax) {
    // Two images at one place see the same ray: no depth.
    model.set_pose(1, model.pose(0));
    const std::vector<WorkingModel::Feature> candidates{{0, 0}, {1, 0}};
    EXPECT_FALSE(estimate_point(model, candidates, TrackOptions{}).has_value());
}

}  // namespace
}  // namespace psfm
