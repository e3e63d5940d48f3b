// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/solve_global.h"

#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <vector>

#include "stages/reconstruction/build/calibrate_shared.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

/// What a global start works on, kept together since they refer to one another.
struct Start {
    ClusterProblem problem;
    LocalGraph graph;
    std::unique_ptr<CorrespondenceGraph> matches;
    std::unique_ptr<WorkingModel> model;
};

/// @param accepted, calibrated  cameras that pairs were verified with, and what is known of them
Start prepare(const SyntheticScene& scene, std::vector<VerifiedPairPtr> pairs,
              const SolveOptions& options, const std::map<CameraId, Camera>& accepted,
              const std::map<CameraId, Camera>& calibrated) {
    Start start;
    start.problem = problem_of(scene, std::move(pairs), accepted, scene.images.size());
    start.problem.calibrated = calibrated;
    start.problem.fix_intrinsics = calibrated.empty();
    auto graph = make_local_graph(start.problem, options);
    EXPECT_TRUE(graph.ok());
    if (graph.ok()) start.graph = *std::move(graph);
    std::vector<ImageId> ids;
    std::vector<std::uint32_t> counts;
    for (const ClusterImage& image : start.problem.images) {
        ids.push_back(image.id);
        counts.push_back(static_cast<std::uint32_t>(image.keypoints->size()));
    }
    start.matches = std::make_unique<CorrespondenceGraph>(ids, counts, start.graph.pairs);
    start.model = std::make_unique<WorkingModel>(start.problem, *start.matches);
    for (const auto& [id, camera] : start.graph.cameras) start.model->mutable_camera(id) = camera;
    return start;
}

Start prepare(const SyntheticScene& scene, std::vector<VerifiedPairPtr> pairs,
              const SolveOptions& options = {}) {
    return prepare(scene, std::move(pairs), options, scene.cameras, {});
}

Result<GlobalStart> run(Start& start, const SolveOptions& options = {},
                        const std::atomic<bool>* cancel = nullptr) {
    return initialize_globally(*start.model, {start.problem, start.graph, options, cancel});
}

/// A third of a pixel of noise; few features, so that a test takes no longer than a second.
SyntheticScene noisy_scene(synthetic::SceneOptions options, std::uint32_t max_features,
                           std::uint64_t seed) {
    options.visibility.max_features = max_features;
    return synthetic::add_pixel_noise(synthetic::make_scene(options, seed), 0.3, seed);
}

/// Some pairs are wrong altogether: up to 30 matches that mean nothing, and any geometry, or (every
/// second one) a rotation that happens to be right.
std::vector<VerifiedPairPtr> with_wrong_pairs(std::vector<VerifiedPairPtr> pairs, double fraction,
                                              std::uint64_t seed) {
    synthetic::Rng rng(seed);
    bool right_rotation = false;
    for (VerifiedPairPtr& pair : pairs) {
        if (rng.uniform() >= fraction) continue;
        VerifiedPair wrong = *pair;
        std::vector<std::uint32_t> second;
        for (const FeatureMatch& match : wrong.geometry.inliers) second.push_back(match.second);
        rng.shuffle(second);
        for (std::size_t k = 0; k < second.size(); ++k) {
            wrong.geometry.inliers[k].second = second[k];
        }
        if (wrong.geometry.inliers.size() > 30) wrong.geometry.inliers.resize(30);
        wrong.geometry.cam2_from_cam1.translation = rng.direction();
        if (!right_rotation) wrong.geometry.cam2_from_cam1.rotation = rng.rotation();
        right_rotation = !right_rotation;
        pair = std::make_shared<const VerifiedPair>(std::move(wrong));
    }
    return pairs;
}

synthetic::ReconstructionError error_of(const Start& start, const SyntheticScene& scene) {
    const auto error = synthetic::compare_with_truth(start.model->save(), scene);
    EXPECT_TRUE(error.ok());
    return error.ok() ? *error : synthetic::ReconstructionError{};
}

TEST(InitializeGlobally, PlacesARingWithNoiseAndWrongPairs) {
    const SyntheticScene scene = noisy_scene(synthetic::ring_around_sphere(60), 120, 1);
    const auto pairs = with_wrong_pairs(synthetic::make_verified_pairs(scene), 0.1, 2);
    Start start = prepare(scene, pairs);
    const auto done = run(start);
    ASSERT_TRUE(done.ok()) << done.error().message;
    EXPECT_EQ(done->placed, 60U);
    EXPECT_GT(done->wrong_directions, 0U);
    EXPECT_GE(done->full_adjustments, 2U);
    const auto error = error_of(start, scene);
    EXPECT_LT(error.max_position, 0.04);  // of a ring of 8 m radius
    EXPECT_LT(error.max_rotation_deg, 0.2);
    EXPECT_LT(error.median_point, 0.02);
}

TEST(InitializeGlobally, PlacesAGridWithNoiseAndWrongPairs) {
    const SyntheticScene scene = noisy_scene(synthetic::grid_over_ground(100), 120, 3);
    const auto pairs = with_wrong_pairs(synthetic::make_verified_pairs(scene), 0.1, 4);
    Start start = prepare(scene, pairs);
    const auto done = run(start);
    ASSERT_TRUE(done.ok()) << done.error().message;
    EXPECT_EQ(done->placed, 100U);
    const auto error = error_of(start, scene);
    EXPECT_LT(error.max_position, 0.1);  // of a grid of 30 m, 9 m above ground
    EXPECT_LT(error.max_rotation_deg, 0.5);
}

TEST(InitializeGlobally, PlacesALineOfCamerasByItsTracks) {
    synthetic::SceneOptions options = synthetic::line_along_wall(60);
    options.cameras.shift_sigma = 0.0;
    const SyntheticScene scene = noisy_scene(options, 120, 5);
    const auto pairs = synthetic::make_verified_pairs(scene);
    Start start = prepare(scene, pairs);
    const auto done = run(start);
    ASSERT_TRUE(done.ok()) << done.error().message;
    EXPECT_EQ(done->placed, 60U);
    EXPECT_LT(error_of(start, scene).max_position, 1.2);  // of a line of 120 m

    SolveOptions without;
    without.global.tracks_per_image = 0;
    Start blind = prepare(scene, pairs);
    const auto failed = run(blind, without);
    ASSERT_FALSE(failed.ok());
    EXPECT_EQ(failed.error().code, ErrorCode::kDegenerate);
    EXPECT_EQ(blind.model->registered_count(), 0U);
}

/// Pairs that were verified with a focal length 4 per cent too long and no distortion bend a line,
/// and adjustment does not straighten it.
TEST(InitializeGlobally, SeesPairsThroughCamerasThatOtherModelsCalibrated) {
    synthetic::SceneOptions options = synthetic::line_along_wall(60);
    options.cameras.k1 = -0.1;
    const SyntheticScene scene = noisy_scene(options, 120, 11);
    std::map<CameraId, Camera> believed;
    std::map<CameraId, Camera> calibrated = scene.cameras;
    for (auto& [id, camera] : calibrated) {
        camera.focal_source = FocalSource::kEstimated;
        believed[id] =
            make_camera(camera.width, camera.height, 1.04 * camera.fx(), FocalSource::kExif);
    }
    LocalGraph as_verified;
    as_verified.cameras = believed;
    as_verified.pairs = synthetic::make_verified_pairs(scene);
    const ClusterProblem problem = problem_of(scene, as_verified.pairs, believed, 60);
    Start start = prepare(scene, pairs_seen_through(believed, problem, as_verified, {}), {},
                          believed, calibrated);
    const auto done = run(start);
    ASSERT_TRUE(done.ok()) << done.error().message;
    EXPECT_EQ(done->placed, 60U);
    EXPECT_LT(error_of(start, scene).max_position, 1.2);  // of a line of 120 m
}

TEST(InitializeGlobally, LeavesUnconnectedImagesToOthers) {
    const SyntheticScene scene = noisy_scene(synthetic::ring_around_sphere(20), 120, 6);
    auto pairs = synthetic::make_verified_pairs(scene);
    std::erase_if(pairs, [](const VerifiedPairPtr& pair) {
        return (index_of(pair->pair.first) < 4) != (index_of(pair->pair.second) < 4);
    });
    Start start = prepare(scene, pairs);
    const auto done = run(start);
    ASSERT_TRUE(done.ok()) << done.error().message;
    EXPECT_EQ(done->placed, 16U);
    for (std::uint32_t image = 0; image < 20; ++image) {
        EXPECT_EQ(start.model->registered(image), image >= 4);
    }
}

TEST(InitializeGlobally, HasNothingToSayOfPureRotations) {
    synthetic::SceneOptions options = synthetic::ring_in_room(20);
    options.cameras.radius = 0.0;
    options.cameras.shift_sigma = 0.0;
    const SyntheticScene scene = noisy_scene(options, 200, 7);
    Start start = prepare(scene, synthetic::make_verified_pairs(scene));
    SolveOptions without;
    without.global.tracks_per_image = 0;
    const auto done = run(start, without);
    ASSERT_FALSE(done.ok());
    EXPECT_EQ(done.error().code, ErrorCode::kDegenerate);
}

TEST(InitializeGlobally, IsBitwiseRepeatable) {
    const SyntheticScene scene = noisy_scene(synthetic::ring_around_sphere(20), 120, 8);
    const auto pairs = with_wrong_pairs(synthetic::make_verified_pairs(scene), 0.05, 9);
    Start a = prepare(scene, pairs);
    Start b = prepare(scene, pairs);
    ASSERT_TRUE(run(a).ok() && run(b).ok());
    const Reconstruction model_a = a.model->save();
    const Reconstruction model_b = b.model->save();
    ASSERT_EQ(model_a.images.size(), model_b.images.size());
    for (std::size_t i = 0; i < model_a.images.size(); ++i) {
        EXPECT_EQ(model_a.images[i].cam_from_cluster.translation,
                  model_b.images[i].cam_from_cluster.translation);
    }
    ASSERT_EQ(model_a.points.size(), model_b.points.size());
    for (std::size_t i = 0; i < model_a.points.size(); ++i) {
        ASSERT_EQ(model_a.points[i].position, model_b.points[i].position);
    }
}

TEST(InitializeGlobally, StopsOnRequest) {
    const SyntheticScene scene = noisy_scene(synthetic::ring_around_sphere(10), 120, 10);
    Start start = prepare(scene, synthetic::make_verified_pairs(scene));
    const std::atomic<bool> cancel{true};
    const auto done = run(start, {}, &cancel);
    ASSERT_FALSE(done.ok());
    EXPECT_EQ(done.error().code, ErrorCode::kCancelled);
    EXPECT_EQ(start.model->registered_count(), 0U);
}

}  // namespace
}  // namespace psfm
