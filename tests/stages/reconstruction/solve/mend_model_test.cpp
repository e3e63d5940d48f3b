// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/mend_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <vector>

#include "stages/reconstruction/checks/contradiction.h"
#include "tests/stages/reconstruction/scene_model.h"
#include "tests/synthetic/compare.h"

namespace psfm {
namespace {

using testing::ElementsAre;

constexpr std::uint32_t kSmall = 24;
constexpr std::uint32_t kLarge = 210;  ///< enough for parts to be joined again

Eigen::Quaterniond turn_by(double degrees) {
    return Eigen::Quaterniond(
        Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ()));
}

/// A ring of photographs around a ball, or many in a room, its true model, and averaged rotations
/// that are right; tests then make one of the two wrong.
class MendModel : public testing::Test {
  protected:
    void make(std::uint32_t images) {
        // In the room an image shares points with those next to it only, as in a long session.
        synthetic::SceneOptions options = images < kLarge ? synthetic::ring_around_sphere(images)
                                                          : synthetic::ring_in_room(images);
        options.points.count = 2000;
        truth_ = std::make_unique<SceneModel>(synthetic::make_scene(options, 5));
        truth_->problem.fix_intrinsics = true;
        graph_ = truth_->true_graph();
        state_ = {.images_at_full_adjustment = images, .images_at_start = images};
    }

    WorkingModel& model() const { return *truth_->model; }

    /// Places an image elsewhere, its observations as they are.
    void misplace(std::uint32_t image, double degrees) const {
        Rigid3 pose = model().pose(image);
        pose.rotation = pose.rotation * turn_by(degrees);
        pose.translation += Eigen::Vector3d(0.5, 0.0, 0.5);
        model().set_pose(image, pose);
    }

    /// Images from `first` on stand elsewhere, with all they see: what other images see as well is
    /// there twice.
    void fold(std::uint32_t first, double degrees) {
        const Sim3 folded{1.0, turn_by(degrees), Eigen::Vector3d(1.0, 0.5, 0.0)};
        Reconstruction whole = model().save();
        std::vector<ScenePoint> points;
        for (const ScenePoint& point : whole.points) {
            std::map<bool, ScenePoint> halves;
            for (const Observation& seen : point.track)
                halves[index_of(seen.image) >= first].track.push_back(seen);
            for (auto& [is_folded, half] : halves) {
                if (half.track.size() < 2) continue;
                half.position = is_folded ? folded * point.position : point.position;
                points.push_back(half);
            }
        }
        whole.points = std::move(points);
        for (RegisteredImage& image : whole.images) {
            if (index_of(image.image) >= first)
                image.cam_from_cluster = transform_pose(image.cam_from_cluster, folded);
        }
        truth_->model = std::make_unique<WorkingModel>(truth_->problem, *truth_->matches);
        model().load(whole);
    }

    /// The one place that knows how it is called.
    Result<void> mend(const std::atomic<bool>* cancel = nullptr) {
        SolveDraft draft{std::move(model()), state_, statistics_};
        const auto done = mend_model(draft, {truth_->problem, graph_, options_, cancel});
        model() = std::move(draft.model);
        state_ = draft.state;
        statistics_ = draft.statistics;
        return done;
    }

    Contradiction contradiction() const {
        return find_contradiction(model(), graph_, options_.max_contradiction_deg);
    }

    double max_error() const {
        const auto error = synthetic::compare_with_truth(model().save(), truth_->scene);
        EXPECT_TRUE(error.ok());
        return error.ok() ? error->max_position : 1e9;
    }

    std::unique_ptr<SceneModel> truth_;
    LocalGraph graph_;
    SolveOptions options_;
    SolveState state_;
    SolveStatistics statistics_;
};

TEST_F(MendModel, AFewImagesArePlacedAnew) {
    make(kSmall);
    misplace(5, 40.0);
    misplace(14, 25.0);
    state_.new_start_is_due = true;
    const Contradiction before = contradiction();
    ASSERT_GT(before.beyond, 0U);
    ASSERT_GT(max_error(), 0.4);
    ASSERT_TRUE(mend().ok());
    EXPECT_EQ(model().registered_count(), kSmall);
    EXPECT_EQ(contradiction().beyond, 0U);
    EXPECT_LT(max_error(), 0.01);  // of a ring of 8 m radius
    EXPECT_EQ(statistics_.registered, 2U);

    ASSERT_TRUE(statistics_.reset.has_value());
    EXPECT_EQ(statistics_.reset->reason, Reset::Reason::kContradiction);
    EXPECT_THAT(statistics_.reset->images, ElementsAre(ImageId{5}, ImageId{14}));
    EXPECT_EQ(statistics_.reset->placed_before, kSmall);
    EXPECT_EQ(statistics_.reset->contradiction.beyond, before.beyond);
    EXPECT_NEAR(statistics_.reset->contradiction.angle_deg, 40.0, 1e-4);
    EXPECT_LT(state_.tolerated_contradiction_deg, 1.0);
    EXPECT_EQ(state_.images_at_contradiction, kSmall);
    EXPECT_FALSE(state_.new_start_is_due);
}

// The average is wrong, so that the image comes to stand where it was.
TEST_F(MendModel, WhatContradictsAfterwardsAsBeforeStaysABadConfiguration) {
    make(kSmall);
    graph_.rotations[5] = graph_.rotations[5] * turn_by(40.0);
    state_.new_start_is_due = true;
    const std::uint32_t beyond = contradiction().beyond;
    ASSERT_GT(beyond, options_.max_contradicting_edges * contradiction().edges);
    ASSERT_TRUE(mend().ok());
    EXPECT_EQ(model().registered_count(), kSmall);
    EXPECT_EQ(contradiction().beyond, beyond);
    EXPECT_LT(max_error(), 0.01);
    EXPECT_FALSE(statistics_.reset.has_value());
    EXPECT_EQ(state_.images_at_contradiction, 0U);
    EXPECT_TRUE(state_.new_start_is_due);
}

// Of hundreds of edges; these the average may have wrong.
TEST_F(MendModel, AFewEdgesMayContradictAfterwards) {
    make(kSmall);
    graph_.rotations[5] = graph_.rotations[5] * turn_by(40.0);
    options_.max_contradicting_edges = 0.5;
    ASSERT_TRUE(mend().ok());
    ASSERT_TRUE(statistics_.reset.has_value());
    EXPECT_THAT(statistics_.reset->images, ElementsAre(ImageId{5}));
    EXPECT_NEAR(state_.tolerated_contradiction_deg, 40.0, 1.0);
    EXPECT_EQ(state_.images_at_contradiction, kSmall);
}

TEST_F(MendModel, ASmallModelThatIsFoldedIsLeftToANewStart) {
    make(kSmall);
    fold(kSmall / 2, 60.0);
    const Contradiction before = contradiction();
    ASSERT_GT(before.beyond, 0U);
    const std::vector<WorkingModel::Point> points = model().points();
    ASSERT_TRUE(mend().ok());
    EXPECT_FALSE(statistics_.reset.has_value());
    EXPECT_EQ(contradiction().beyond, before.beyond);
    EXPECT_EQ(contradiction().angle_deg, before.angle_deg);
    EXPECT_EQ(model().points().size(), points.size());
    EXPECT_EQ(statistics_.registered, 0U);
}

TEST_F(MendModel, PartsOfALargeModelAreJoinedAgain) {
    make(kLarge);
    fold(130, 60.0);
    ASSERT_GT(contradiction().beyond, 0U);
    ASSERT_GT(max_error(), 0.5);
    ASSERT_TRUE(mend().ok());
    EXPECT_EQ(model().registered_count(), kLarge);
    EXPECT_EQ(contradiction().beyond, 0U);
    EXPECT_LT(max_error(), 0.01);
    ASSERT_TRUE(statistics_.reset.has_value());
    ASSERT_EQ(statistics_.reset->images.size(), kLarge - 130) << "the smaller part";
    EXPECT_EQ(statistics_.reset->images.front(), ImageId{130});
    EXPECT_GT(statistics_.full_adjustments, 0U);
    EXPECT_EQ(state_.images_at_contradiction, kLarge);
    EXPECT_EQ(state_.images_at_full_adjustment, kLarge);
}

// The average says that the model is folded, and the points say that it is not.
TEST_F(MendModel, PartsThatComeToStandWhereTheyWereStayThere) {
    make(kLarge);
    for (std::uint32_t image = 130; image < kLarge; ++image)
        graph_.rotations[image] = graph_.rotations[image] * turn_by(60.0);
    const std::uint32_t beyond = contradiction().beyond;
    ASSERT_GT(beyond, 0U);
    const std::size_t points = model().alive_points();
    ASSERT_TRUE(mend().ok());
    EXPECT_FALSE(statistics_.reset.has_value());
    EXPECT_EQ(contradiction().beyond, beyond);
    EXPECT_EQ(model().alive_points(), points);
    EXPECT_EQ(statistics_.full_adjustments, 0U) << "of what was tried nothing counts";
    EXPECT_EQ(state_.images_at_contradiction, 0U);
}

// One part is folded; of two others the average says so, and nothing helps.
TEST_F(MendModel, HardlyAnythingGainedIsNotKept) {
    make(kLarge);
    fold(170, 60.0);
    for (std::uint32_t image = 20; image < 110; ++image) {
        if (image < 50 || image >= 80)
            graph_.rotations[image] = graph_.rotations[image] * turn_by(60.0);
    }
    const std::uint32_t beyond = contradiction().beyond;
    const double error = max_error();
    ASSERT_TRUE(mend().ok());
    EXPECT_FALSE(statistics_.reset.has_value());
    EXPECT_EQ(contradiction().beyond, beyond);
    EXPECT_EQ(max_error(), error);

    options_.reset.max_left = 1.0;
    ASSERT_TRUE(mend().ok());
    EXPECT_LT(contradiction().beyond, beyond) << "what is hardly anything is an option";
    EXPECT_NE(max_error(), error);
}

TEST_F(MendModel, StopsOnRequest) {
    make(kSmall);
    misplace(5, 40.0);
    const std::atomic<bool> cancel{true};
    const auto stopped = mend(&cancel);
    ASSERT_FALSE(stopped.ok());
    EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
    EXPECT_FALSE(statistics_.reset.has_value());
}

}  // namespace
}  // namespace psfm
