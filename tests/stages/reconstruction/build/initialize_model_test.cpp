// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/initialize_model.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/stages/reconstruction/scene_model.h"
#include "tests/synthetic/disturb.h"

namespace psfm {
namespace {

using Seed = std::pair<std::uint32_t, std::uint32_t>;

/// Cameras on an arc around a ball, and nothing placed yet.
class InitializeModel : public testing::Test {
  protected:
    void make(std::uint32_t images, double arc_deg = 360.0, double noise_px = 0.3) {
        synthetic::SceneOptions options = synthetic::ring_around_sphere(images);
        options.cameras.arc_deg = arc_deg;
        options.cameras.shift_sigma = 0.0;  // nothing but the arc makes angles
        truth_ = std::make_unique<SceneModel>(
            synthetic::add_pixel_noise(synthetic::make_scene(options, 3), noise_px, 4));
        truth_->problem.fix_intrinsics = true;
        graph_ = truth_->true_graph();
        model_ = std::make_unique<WorkingModel>(truth_->problem, *truth_->matches);
        exclude_.assign(images, false);
    }

    Result<Seed> start() { return initialize_model(*model_, graph_, exclude_, options_); }

    /// Changes the pairs that are of two images.
    void change(const Seed& seed, const std::function<void(TwoViewGeometry&)>& change_one) {
        change_if([&](const VerifiedPair& pair) { return ends_of(pair) == seed; }, change_one);
    }
    void change_if(const std::function<bool(const VerifiedPair&)>& is_meant,
                   const std::function<void(TwoViewGeometry&)>& change_one) {
        for (VerifiedPairPtr& pair : graph_.pairs) {
            if (!is_meant(*pair)) continue;
            VerifiedPair changed = *pair;
            change_one(changed.geometry);
            pair = std::make_shared<const VerifiedPair>(std::move(changed));
        }
    }
    static bool every(const VerifiedPair& /*pair*/) { return true; }
    static Seed ends_of(const VerifiedPair& pair) {
        return {index_of(pair.pair.first), index_of(pair.pair.second)};
    }

    /// As the header promises: two images in the frame of the first, and enough points that they
    /// see at a large angle.
    void expect_model_of(const Seed& seed, double min_angle_deg) const {
        EXPECT_EQ(model_->registered_count(), 2U);
        ASSERT_TRUE(model_->registered(seed.first) && model_->registered(seed.second));
        EXPECT_GE(model_->alive_points(), options_.initialization.min_points);
        const Rigid3 found = model_->pose(seed.second) * inverse(model_->pose(seed.first));
        const Rigid3 planted = truth_->scene.images[seed.second].cam_from_world *
                               inverse(truth_->scene.images[seed.first].cam_from_world);
        constexpr double kDegrees = 180.0 / std::numbers::pi;
        EXPECT_LT(kDegrees * found.rotation.angularDistance(planted.rotation), 0.5);
        EXPECT_GT(found.translation.normalized().dot(planted.translation.normalized()),
                  std::cos(1.0 / kDegrees));
        EXPECT_GE(median_angle_deg(seed), min_angle_deg);
    }

    void expect_nothing_placed() const {
        EXPECT_EQ(model_->registered_count(), 0U);
        EXPECT_EQ(model_->alive_points(), 0U);
    }

    double median_angle_deg(const Seed& seed) const {
        std::vector<double> angles;
        for (const WorkingModel::Point& point : model_->points()) {
            if (!point.alive()) continue;
            const Eigen::Vector3d first = model_->centre(seed.first) - point.position;
            const Eigen::Vector3d second = model_->centre(seed.second) - point.position;
            angles.push_back(180.0 / std::numbers::pi *
                             std::atan2(first.cross(second).norm(), first.dot(second)));
        }
        std::ranges::sort(angles);
        return angles.empty() ? 0.0 : angles[angles.size() / 2];
    }

    std::unique_ptr<SceneModel> truth_;
    LocalGraph graph_;
    std::unique_ptr<WorkingModel> model_;
    std::vector<bool> exclude_;
    SolveOptions options_;
};

// Neighbours share most points, and see them at 13 degrees.
TEST_F(InitializeModel, StartsFromManyInliersAtALargeAngle) {
    make(36);
    const auto seed = start();
    ASSERT_TRUE(seed.ok()) << seed.error().message;
    EXPECT_LT(seed->first, seed->second);
    expect_model_of(*seed, options_.initialization.min_angle_deg);
    const auto steps = std::min(seed->second - seed->first, 36 + seed->first - seed->second);
    EXPECT_GE(steps, 2U);
    EXPECT_LE(steps, 4U) << "which share far fewer";
}

TEST_F(InitializeModel, IsContentWithLessWhereNothingBetterIsThere) {
    make(5, 4.0, 0.1);
    const auto seed = start();
    ASSERT_TRUE(seed.ok()) << "halved three times, 16 degrees are 2";
    expect_model_of(*seed, 2.0);
    EXPECT_LT(median_angle_deg(*seed), 8.0);
}

TEST_F(InitializeModel, ThatHasAnEnd) {
    make(5, 1.0, 0.1);
    const auto seed = start();
    ASSERT_FALSE(seed.ok());
    EXPECT_EQ(seed.error().code, ErrorCode::kNoSeed);
    expect_nothing_placed();
}

TEST_F(InitializeModel, APairThatATryBeganFromIsLeftOut) {
    make(12);
    const auto first = start();
    ASSERT_TRUE(first.ok());
    exclude_[first->first] = exclude_[first->second] = true;
    model_ = std::make_unique<WorkingModel>(truth_->problem, *truth_->matches);
    const auto second = start();
    ASSERT_TRUE(second.ok());
    EXPECT_NE(*second, *first);
    EXPECT_FALSE(exclude_[second->first] && exclude_[second->second]);
    expect_model_of(*second, options_.initialization.min_angle_deg);

    exclude_.assign(12, true);
    model_ = std::make_unique<WorkingModel>(truth_->problem, *truth_->matches);
    EXPECT_EQ(start().error().code, ErrorCode::kNoSeed);
    expect_nothing_placed();
}

TEST_F(InitializeModel, APlaneStartsLessReliably) {
    make(12);
    const auto seed = start();
    ASSERT_TRUE(seed.ok());
    change(*seed, [](TwoViewGeometry& geometry) { geometry.kind = TwoViewKind::kPlanar; });
    model_ = std::make_unique<WorkingModel>(truth_->problem, *truth_->matches);
    const auto other = start();
    ASSERT_TRUE(other.ok());
    EXPECT_NE(*other, *seed);

    change_if(every, [](TwoViewGeometry& geometry) { geometry.kind = TwoViewKind::kPlanar; });
    model_ = std::make_unique<WorkingModel>(truth_->problem, *truth_->matches);
    const auto planar = start();
    ASSERT_TRUE(planar.ok()) << "it does where there is nothing else";
    EXPECT_EQ(*planar, *seed);
}

TEST_F(InitializeModel, ATurnIsNoStart) {
    make(12);
    change_if(every, [](TwoViewGeometry& geometry) { geometry.kind = TwoViewKind::kPureRotation; });
    EXPECT_EQ(start().error().code, ErrorCode::kNoSeed);
    expect_nothing_placed();
}

TEST_F(InitializeModel, FewInliersAreNone) {
    make(12);
    change_if(every, [&](TwoViewGeometry& geometry) {
        geometry.inliers.resize(
            std::min<std::size_t>(geometry.inliers.size(), options_.initialization.min_points - 1));
    });
    EXPECT_EQ(start().error().code, ErrorCode::kNoSeed);
    expect_nothing_placed();
    graph_ = {};
    EXPECT_EQ(start().error().code, ErrorCode::kNoSeed) << "without a pair, either";
}

// Verified wrongly: its points are triangulated, and there are none.
TEST_F(InitializeModel, APairThatItsMatchesDoNotBearOutIsPassedOver) {
    make(12);
    const auto seed = start();
    ASSERT_TRUE(seed.ok());
    change(*seed, [](TwoViewGeometry& geometry) {
        Rigid3& pose = geometry.cam2_from_cam1;
        pose.rotation = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX()) * pose.rotation;
    });
    model_ = std::make_unique<WorkingModel>(truth_->problem, *truth_->matches);
    const auto other = start();
    ASSERT_TRUE(other.ok());
    EXPECT_NE(*other, *seed);
    expect_model_of(*other, options_.initialization.min_angle_deg);
}

TEST_F(InitializeModel, TriesSoManyPairs) {
    make(12);
    options_.initialization.max_pairs = 1;
    const auto seed = start();
    ASSERT_TRUE(seed.ok());
    change(*seed, [](TwoViewGeometry& geometry) {
        Rigid3& pose = geometry.cam2_from_cam1;
        pose.rotation = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX()) * pose.rotation;
    });
    model_ = std::make_unique<WorkingModel>(truth_->problem, *truth_->matches);
    EXPECT_EQ(start().error().code, ErrorCode::kNoSeed);
    expect_nothing_placed();
}

}  // namespace
}  // namespace psfm
