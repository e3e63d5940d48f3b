// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/local_graph.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

ClusterProblem ring_problem() {
    const auto scene = synthetic::make_scene(synthetic::ring_around_sphere(8), 1);
    return problem_of(scene, synthetic::make_verified_pairs(scene));
}

Camera with_focal(Camera camera, double focal_px) {
    camera.params[0] = focal_px;
    return camera;
}

double starting_focal(const ClusterProblem& problem) {
    const auto graph = make_local_graph(problem, {});
    EXPECT_TRUE(graph.ok());
    return graph.ok() ? graph->cameras.begin()->second.fx() : 0.0;
}

TEST(LocalGraph, StartsFromTheIntrinsicsThatAreKnownBest) {
    ClusterProblem problem = ring_problem();
    const auto [id, accepted] = *problem.cameras.begin();
    EXPECT_EQ(starting_focal(problem), accepted.fx());
    problem.calibrated[id] = with_focal(accepted, accepted.fx() + 10.0);
    EXPECT_EQ(starting_focal(problem), accepted.fx() + 10.0) << "another cluster's";
    Reconstruction own;
    own.cameras[id] = with_focal(accepted, accepted.fx() + 20.0);
    for (const std::uint32_t images : {4U, 5U}) {
        own.images.assign(images, RegisteredImage{});
        problem.recycled = {std::make_shared<const Reconstruction>(own)};
        EXPECT_EQ(starting_focal(problem), accepted.fx() + (images < 5 ? 10.0 : 20.0))
            << "its own model's, where that has enough images to tell";
    }
    problem.calibrated[CameraId{77}] = accepted;
    EXPECT_FALSE(make_local_graph(problem, {})->cameras.contains(CameraId{77}));
}

/// Two parts of a ring. True edges between them are few; most pairs across look as if one part
/// stood elsewhere, with as many inliers each, of all that both images show.
ClusterProblem folded_problem(std::set<ImagePair>& wrong) {
    const auto scene = synthetic::make_scene(synthetic::ring_around_sphere(12), 3);
    ClusterProblem problem = problem_of(scene, synthetic::make_verified_pairs(scene));
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY()));
    std::vector<VerifiedPairPtr> pairs = pairs_of(problem);
    for (VerifiedPairPtr& pair : pairs) {
        VerifiedPair changed = *pair;
        TwoViewGeometry& geometry = changed.geometry;
        geometry.inliers.resize(std::min<std::size_t>(geometry.inliers.size(), 60));
        geometry.median_angle_deg = 10.0;
        geometry.match_density = 0.12;
        const bool across = index_of(pair->pair.first) < 6 && index_of(pair->pair.second) >= 6;
        if (across && wrong.size() < 8) {
            geometry.match_density = 0.03;
            const auto rotation = [&](ImageId image) {
                return scene.images[index_of(image)].cam_from_world.rotation;
            };
            geometry.cam2_from_cam1.rotation =
                rotation(pair->pair.second) * turn * rotation(pair->pair.first).conjugate();
            wrong.insert(pair->pair);
        }
        pair = std::make_shared<const VerifiedPair>(changed);
    }
    std::size_t right = 0;
    std::erase_if(pairs, [&](const VerifiedPairPtr& pair) {
        const bool across = index_of(pair->pair.first) < 6 && index_of(pair->pair.second) >= 6;
        return across && !wrong.contains(pair->pair) && ++right > 3;
    });
    problem.view_graph = ViewGraph(pairs);
    return problem;
}

TEST(LocalGraph, FewPlausibleEdgesOutweighManyLookAlikes) {
    std::set<ImagePair> wrong;
    const ClusterProblem problem = folded_problem(wrong);
    ASSERT_EQ(wrong.size(), 8U);
    const auto kept_wrong = [&](const SolveOptions& options) {
        const auto graph = make_local_graph(problem, options);
        EXPECT_TRUE(graph.ok());
        return std::ranges::count_if(
            graph->pairs, [&](const VerifiedPairPtr& pair) { return wrong.contains(pair->pair); });
    };
    SolveOptions options;
    EXPECT_EQ(kept_wrong(options), 0);
    options.plausibility.reset();
    EXPECT_EQ(kept_wrong(options), 8);
}

}  // namespace
}  // namespace psfm
