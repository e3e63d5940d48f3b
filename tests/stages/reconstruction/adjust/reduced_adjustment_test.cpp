// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/reduced_adjustment.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <memory>

#include "tests/stages/reconstruction/scene_model.h"
#include "tests/synthetic/disturb.h"

namespace psfm {
namespace {

/// The model of a ring of cameras, its truth disturbed alike each time.
struct DisturbedRing : SceneModel {
    explicit DisturbedRing(std::uint32_t images = 16)
        : SceneModel(synthetic::add_pixel_noise(
              synthetic::make_scene(synthetic::ring_around_sphere(images), 3), 0.5, 4)) {
        disturb(0.01, 7);
    }

    AdjustmentScope scope(bool free_intrinsics) const {
        AdjustmentScope all = full_scope(*model, free_intrinsics);
        all.free_principal_points = all.free_cameras;
        return all;
    }
};

AdjustmentOptions precise(bool reduced) {
    AdjustmentOptions options;
    options.function_tolerance = 1e-14;
    options.max_iterations = 100;
    if (!reduced) options.max_reduced_mib = 0;
    return options;
}

/// Largest difference of poses, points and intrinsics, the latter relative to the focal length.
double difference(const WorkingModel& a, const WorkingModel& b) {
    double most = 0.0;
    for (std::uint32_t image = 0; image < a.image_count(); ++image) {
        most = std::max(most, (a.pose(image).translation - b.pose(image).translation).norm());
        most = std::max(most, a.pose(image).rotation.angularDistance(b.pose(image).rotation));
    }
    for (std::uint32_t point = 0; point < a.points().size(); ++point)
        most = std::max(most, (a.points()[point].position - b.points()[point].position).norm());
    for (const auto& [id, camera] : a.cameras()) {
        for (std::size_t i = 0; i < camera.params.size(); ++i) {
            most = std::max(
                most, std::abs(camera.params[i] - b.cameras().at(id).params[i]) / camera.params[0]);
        }
    }
    return most;
}

TEST(AdjustReduced, EndsWhereCeresEnds) {
    for (const bool free_intrinsics : {false, true}) {
        const DisturbedRing ours, ceres;
        const auto start = difference(*ours.model, *ceres.model);
        ASSERT_EQ(start, 0.0);
        const auto reduced = adjust(*ours.model, ours.scope(free_intrinsics), precise(true));
        const auto whole = adjust(*ceres.model, ceres.scope(free_intrinsics), precise(false));
        ASSERT_TRUE(reduced.ok() && whole.ok());
        EXPECT_EQ(reduced->residuals, whole->residuals);
        EXPECT_NEAR(reduced->rms_before_px, whole->rms_before_px, 1e-9);
        EXPECT_NEAR(reduced->rms_after_px, whole->rms_after_px, 1e-7);
        EXPECT_LT(reduced->rms_after_px, 0.3 * reduced->rms_before_px);
        EXPECT_LT(difference(*ours.model, *ceres.model), 1e-4) << free_intrinsics;
    }
}

TEST(AdjustReduced, ManyImagesAreEliminatedInAnotherOrderToTheSameEnd) {
    const DisturbedRing ours(130), ceres(130);
    const auto reduced = adjust(*ours.model, ours.scope(true), precise(true));
    const auto whole = adjust(*ceres.model, ceres.scope(true), precise(false));
    ASSERT_TRUE(reduced.ok() && whole.ok());
    EXPECT_NEAR(reduced->rms_before_px, whole->rms_before_px, 1e-9);
    EXPECT_NEAR(reduced->rms_after_px, whole->rms_after_px, 1e-7);
    EXPECT_LT(difference(*ours.model, *ceres.model), 1e-4);
}

TEST(AdjustReduced, APathLeavesTilesEmptyAndEndsWhereCeresEnds) {
    struct Path : SceneModel {
        Path() : SceneModel(synthetic::make_scene(synthetic::line_along_wall(250), 3)) {
            disturb(0.003, 7);
        }
    };
    const Path ours, ceres;
    const AdjustmentScope scope = full_scope(*ours.model, false);
    AdjustmentOptions few = precise(true);
    AdjustmentOptions few_with_ceres = precise(false);
    few.max_iterations = few_with_ceres.max_iterations = 5;
    const auto reduced = adjust(*ours.model, scope, few);
    const auto whole = adjust(*ceres.model, scope, few_with_ceres);
    ASSERT_TRUE(reduced.ok() && whole.ok());
    EXPECT_LT(reduced->rms_after_px, 0.3 * reduced->rms_before_px);
    EXPECT_NEAR(reduced->rms_after_px, whole->rms_after_px, 1e-3 * whole->rms_before_px);
}

TEST(AdjustReduced, PartOfAModelIsAdjustedLikewise) {
    const DisturbedRing ours, ceres;
    const std::uint32_t image = 3;
    AdjustmentScope scope = local_scope(*ours.model, std::span(&image, 1), 5, 15, true);
    ASSERT_LT(scope.free_images.size(), ours.model->image_count());
    ASSERT_TRUE(adjust(*ours.model, scope, precise(true)).ok());
    ASSERT_TRUE(adjust(*ceres.model, scope, precise(false)).ok());
    EXPECT_LT(difference(*ours.model, *ceres.model), 1e-4);
}

TEST(AdjustReduced, LeavesTheModelAsItIsWhenItIsCancelled) {
    const DisturbedRing ring, before;
    const std::atomic<bool> cancel{true};
    const auto report = adjust(*ring.model, ring.scope(true), precise(true), &cancel);
    ASSERT_FALSE(report.ok());
    EXPECT_EQ(report.error().code, ErrorCode::kCancelled);
    EXPECT_EQ(difference(*ring.model, *before.model), 0.0);
}

TEST(AdjustReduced, GaugeStays) {
    const DisturbedRing ring, before;
    const AdjustmentScope scope = ring.scope(true);
    ASSERT_TRUE(adjust(*ring.model, scope, precise(true)).ok());
    EXPECT_EQ(ring.model->pose(scope.gauge->origin).translation,
              before.model->pose(scope.gauge->origin).translation);
    const int held = scale_coordinate(*before.model, *scope.gauge);
    EXPECT_EQ(ring.model->pose(scope.gauge->farthest).translation[held],
              before.model->pose(scope.gauge->farthest).translation[held]);
    EXPECT_NE(ring.model->pose(scope.gauge->farthest).translation,
              before.model->pose(scope.gauge->farthest).translation);
}

TEST(AdjustReduced, IsBitwiseTheSameOnAnyNumberOfThreads) {
    std::unique_ptr<DisturbedRing> first;
    for (const std::size_t threads : {1U, 2U, 5U}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        auto ring = std::make_unique<DisturbedRing>();
        ASSERT_TRUE(adjust(*ring->model, ring->scope(true), precise(true)).ok());
        if (!first) {
            first = std::move(ring);
        } else {
            EXPECT_EQ(difference(*first->model, *ring->model), 0.0) << threads;
        }
    }
}

TEST(AdjustReduced, APointBehindACameraIsLeftOutAsInCeres) {
    const DisturbedRing ours, ceres;
    for (const DisturbedRing* ring : {&ours, &ceres}) {
        const Eigen::Vector3d behind = 3.0 * ring->model->centre(0);
        ring->model->set_position(0, behind);
    }
    const auto reduced = adjust(*ours.model, ours.scope(false), precise(true));
    const auto whole = adjust(*ceres.model, ceres.scope(false), precise(false));
    ASSERT_TRUE(reduced.ok() && whole.ok());
    EXPECT_EQ(reduced->residuals, whole->residuals);
    std::size_t observations = 0;
    for (const WorkingModel::Point& point : ours.model->points())
        observations += point.track.size();
    EXPECT_LT(reduced->residuals, observations);
}

}  // namespace
}  // namespace psfm
