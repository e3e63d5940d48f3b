// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/local_graph.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>
#include <vector>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/median.h"
#include "stages/verification/verify_pair.h"
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

TEST(LocalGraph, TurnedPhotographsHaveTheLensOfWhichMoreIsKnown) {
    ClusterProblem problem = ring_problem();
    const auto [owner, accepted] = *problem.cameras.begin();
    constexpr CameraId kTwin{77};
    problem.twins[kTwin] = owner;
    problem.images.back().camera = kTwin;
    const auto focals = [&](FocalSource of_owner, FocalSource of_twin) {
        problem.cameras[owner] = with_focal(accepted, 800.0);
        problem.cameras[owner].focal_source = of_owner;
        problem.cameras[kTwin] = with_focal(accepted, 900.0);
        problem.cameras[kTwin].focal_source = of_twin;
        const auto graph = make_local_graph(problem, {});
        EXPECT_TRUE(graph.ok());
        return std::pair(graph->cameras.at(owner).fx(), graph->cameras.at(kTwin).fx());
    };
    EXPECT_EQ(focals(FocalSource::kExif, FocalSource::kExif), std::pair(800.0, 800.0));
    EXPECT_EQ(focals(FocalSource::kExif, FocalSource::kEstimated), std::pair(900.0, 900.0));
    EXPECT_EQ(focals(FocalSource::kEstimated, FocalSource::kExif), std::pair(800.0, 800.0));
    EXPECT_EQ(focals(FocalSource::kUnknown, FocalSource::kExif), std::pair(900.0, 900.0));
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

/// Photographs through a lens that distorts, whose pairs were verified by a process that did not
/// know of it; a model of five of them does.
struct WideLens {
    synthetic::SyntheticScene scene;
    ClusterProblem problem;

    static constexpr std::uint32_t kInModel = 5;

    /// @param assumed  focal length that pairs were verified with, over the true one
    explicit WideLens(double k1, double assumed = 1.0) {
        synthetic::SceneOptions options = synthetic::ring_around_sphere(8);
        options.cameras.k1 = k1;
        scene = synthetic::make_scene(options, 4);
        const auto [id, lens] = *scene.cameras.begin();
        const Camera accepted =
            make_camera(lens.width, lens.height, assumed * lens.fx(), FocalSource::kUnknown);
        std::vector<VerifiedPairPtr> pairs;
        for (const VerifiedPairPtr& truth : synthetic::make_verified_pairs(scene)) {
            const auto& first = scene.images[index_of(truth->pair.first)].keypoints;
            const auto& second = scene.images[index_of(truth->pair.second)].keypoints;
            auto seen = verify_pair({first, second, accepted, accepted, truth->geometry.inliers},
                                    VerifyOptions{}, 1);
            if (!seen.ok()) continue;
            pairs.push_back(
                std::make_shared<const VerifiedPair>(VerifiedPair{truth->pair, *std::move(seen)}));
        }
        problem = problem_of(scene, pairs, {{id, accepted}}, scene.images.size());
        Reconstruction model;
        model.cameras[id] = lens;
        model.cameras[id].focal_source = FocalSource::kEstimated;
        for (std::uint32_t i = 0; i < kInModel; ++i)
            model.images.push_back({ImageId{i}, id, scene.images[i].cam_from_world});
        problem.recycled = {std::make_shared<const Reconstruction>(model)};
    }

    /// Median error of the relative rotations of the local graph's pairs [deg]: of those between
    /// images of the model, or of the others.
    double median_error_deg(bool within_model, const StrongLensOptions& strong_lenses) const {
        SolveOptions options;
        options.strong_lenses = strong_lenses;
        const auto graph = make_local_graph(problem, options);
        EXPECT_TRUE(graph.ok());
        std::vector<double> errors;
        for (const VerifiedPairPtr& pair : graph->pairs) {
            if ((index_of(pair->pair.second) < kInModel) != within_model) continue;
            const auto rotation = [&](ImageId image) {
                return scene.images[index_of(image)].cam_from_world.rotation;
            };
            const Eigen::Quaterniond truth =
                rotation(pair->pair.second) * rotation(pair->pair.first).conjugate();
            errors.push_back(degrees_from_radians(
                truth.angularDistance(pair->geometry.cam2_from_cam1.rotation)));
        }
        EXPECT_GE(errors.size(), kInModel - 1);
        return upper_median(errors);
    }
};

constexpr StrongLensOptions kNoLensIsStrong{.min_displacement = 0.0};

TEST(LocalGraph, SeesPairsThroughALensThatTurnedOutToBeStrong) {
    const WideLens wide(-0.3);
    EXPECT_GT(wide.median_error_deg(false, kNoLensIsStrong), 0.5) << "bent as they were verified";
    EXPECT_LT(wide.median_error_deg(false, {}), 0.05);
}

TEST(LocalGraph, LeavesPairsAloneThatTheLensHardlyBends) {
    const WideLens narrow(-0.01);
    EXPECT_EQ(narrow.median_error_deg(false, {}), narrow.median_error_deg(false, kNoLensIsStrong));
}

TEST(LocalGraph, LeavesPairsAloneThatTheModelConfirms) {
    const WideLens wide(-0.3);
    const double bent_deg = wide.median_error_deg(true, kNoLensIsStrong);
    EXPECT_GT(bent_deg, 0.1);
    EXPECT_EQ(wide.median_error_deg(true, {.max_bend_deg = 180.0}), bent_deg);
    EXPECT_LT(wide.median_error_deg(true, {.max_bend_deg = 0.0}), 0.05);
}

TEST(LocalGraph, AsksTheModelOfPosesThatFollowFromTheFocalLengthsItFound) {
    const WideLens wide(-0.3, 0.5);
    EXPECT_EQ(wide.median_error_deg(true, {.max_bend_deg = 10.0}),
              wide.median_error_deg(true, kNoLensIsStrong));
}

}  // namespace
}  // namespace psfm
