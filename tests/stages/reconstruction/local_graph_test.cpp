// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/local_graph.h"

#include <gtest/gtest.h>

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
    problem.recycled = {std::make_shared<const Reconstruction>(own)};
    EXPECT_EQ(starting_focal(problem), accepted.fx() + 20.0) << "its own model's";
    problem.calibrated[CameraId{77}] = accepted;
    EXPECT_FALSE(make_local_graph(problem, {})->cameras.contains(CameraId{77}));
}

}  // namespace
}  // namespace psfm
