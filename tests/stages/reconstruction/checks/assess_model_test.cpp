// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/assess_model.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "stages/reconstruction/checks/judged_model.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/scene.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

struct Ring {
    SyntheticScene scene = synthetic::make_scene(synthetic::ring_around_sphere(10), 3);
    Reconstruction model = synthetic::true_reconstruction(scene);
    std::vector<VerifiedPairPtr> pairs = synthetic::make_verified_pairs(scene);
};

/// Some of the pairs labelled as mere turns by an angle.
std::vector<VerifiedPairPtr> as_turns(const Ring& ring, double degrees, std::size_t every) {
    const Eigen::Matrix3d matrix = ring.model.cameras.begin()->second.matrix();
    std::vector<VerifiedPairPtr> labelled;
    for (std::size_t i = 0; i < ring.pairs.size(); ++i) {
        auto pair = std::make_shared<VerifiedPair>(*ring.pairs[i]);
        if (i % every == 0) {
            pair->geometry.kind = TwoViewKind::kPureRotation;
            pair->geometry.cam2_from_cam1.translation.setZero();
            pair->geometry.cam2_from_cam1.rotation =
                Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY());
            pair->geometry.matrix = matrix *
                                    pair->geometry.cam2_from_cam1.rotation.toRotationMatrix() *
                                    matrix.inverse();
        }
        labelled.push_back(std::move(pair));
    }
    return labelled;
}

TEST(HasInventedDepth, StepsAreNone) {
    const Ring ring;
    EXPECT_FALSE(has_invented_depth(ring.model, ring.pairs, {}));
    EXPECT_FALSE(has_invented_depth(ring.model, {}, {}));
    EXPECT_FALSE(has_invented_depth({}, ring.pairs, {}));
}

TEST(HasInventedDepth, TurnsThatTheModelShowsAsStepsAre) {
    const Ring ring;
    EXPECT_TRUE(has_invented_depth(ring.model, as_turns(ring, 20, 1), {}));
    EXPECT_TRUE(has_invented_depth(ring.model, as_turns(ring, 20, 2), {}));
    EXPECT_FALSE(has_invented_depth(ring.model, as_turns(ring, 20, 1), {.max_invented = 0}));
}

TEST(HasInventedDepth, StepsThatAGuessedFocalLengthMadeTurnsAreNone) {
    Ring ring;
    const auto turns = as_turns(ring, 20, 1);
    EXPECT_TRUE(has_invented_depth(ring.model, turns, {}));
    for (auto& [id, camera] : ring.model.cameras) camera.params[0] *= 2.0;
    EXPECT_FALSE(has_invented_depth(ring.model, turns, {}));
}

TEST(HasInventedDepth, ShortStepsPastAPlaneAndFewWrongLabelsAreNone) {
    const Ring ring;
    EXPECT_FALSE(has_invented_depth(ring.model, as_turns(ring, 4, 1), {}));
    EXPECT_FALSE(has_invented_depth(ring.model, as_turns(ring, 20, 20), {}));
}

TEST(HasInventedDepth, TurnsThatTheModelShowsAsTurnsAreNone) {
    // Everything seen from next to nowhere.
    Ring ring;
    const Eigen::Vector3d centre =
        ring.model.images.front().cam_from_cluster.target_origin_in_source();
    for (RegisteredImage& image : ring.model.images) {
        const Eigen::Vector3d own = image.cam_from_cluster.target_origin_in_source();
        image.cam_from_cluster.translation =
            -(image.cam_from_cluster.rotation * (centre + 1e-4 * (own - centre)));
    }
    EXPECT_FALSE(has_invented_depth(ring.model, as_turns(ring, 20, 1), {}));
}

TEST(WeaknessesOf, ASoundModelHasNone) {
    const Ring ring;
    EXPECT_TRUE(weaknesses_of(ring.model, {}).none());
    EXPECT_TRUE(weaknesses_of({}, {}).none());
}

TEST(WeaknessesOf, SmallAngles) {
    Ring ring;
    const Eigen::Vector3d centre =
        ring.model.images.front().cam_from_cluster.target_origin_in_source();
    for (RegisteredImage& image : ring.model.images) {
        const Eigen::Vector3d own = image.cam_from_cluster.target_origin_in_source();
        image.cam_from_cluster.translation =
            -(image.cam_from_cluster.rotation * (centre + 0.01 * (own - centre)));
    }
    EXPECT_EQ(list_of(weaknesses_of(ring.model, {})), std::vector{Weakness::kSmallAngles});
}

TEST(WeaknessesOf, FewPoints) {
    Ring ring;
    auto points = ring.model.points.to_vector();
    std::vector<ScenePoint> few;
    for (std::size_t i = 0; i < points.size(); i += points.size() / 40) few.push_back(points[i]);
    ring.model.points = ScenePoints(few);
    EXPECT_TRUE(weaknesses_of(ring.model, {}).has(Weakness::kFewPoints));
}

TEST(WeaknessesOf, ThinJoint) {
    // The first five images share with the last five what ten points show.
    Ring ring;
    std::vector<ScenePoint> points;
    int across = 0;
    for (ScenePoint& point : ring.model.points.to_vector()) {
        const auto is_first = [](const Observation& o) { return index_of(o.image) < 5; };
        const auto first = std::ranges::count_if(point.track, is_first);
        const bool both = first > 0 && first < std::ssize(point.track);
        if (both && ++across > 10) {
            if (2 * first > std::ssize(point.track)) {
                std::erase_if(point.track, [&](const Observation& o) { return !is_first(o); });
            } else {
                std::erase_if(point.track, is_first);
            }
            if (point.track.size() < 2) continue;
        }
        points.push_back(point);
    }
    ASSERT_GT(across, 10);
    ring.model.points = ScenePoints(points);
    EXPECT_EQ(list_of(weaknesses_of(ring.model, {})), std::vector{Weakness::kThinJoint});
    EXPECT_EQ(loose_images(ring.model, 5, {}), ring.model.images.size() - 5);
    EXPECT_EQ(loose_images(ring.model, ring.model.images.size(), {}), 0U) << "no such part";
    EXPECT_EQ(loose_images(Ring().model, 1, {}), 0U);
    SolveAttempt attempt;
    attempt.model = ring.model;
    attempt.places.emplace();
    EXPECT_EQ(judge(attempt, problem_of(ring.scene, ring.pairs), {}).score.loose, 5U);
}

TEST(WeaknessesOf, ImplausibleFocals) {
    Ring ring;
    Camera& camera = ring.model.cameras.begin()->second;
    camera.focal_source = FocalSource::kEstimated;
    EXPECT_TRUE(weaknesses_of(ring.model, {}).none());
    camera.params[0] *= 8.0;
    EXPECT_EQ(list_of(weaknesses_of(ring.model, {})), std::vector{Weakness::kImplausibleFocal});
    camera.focal_source = FocalSource::kGiven;
    EXPECT_TRUE(weaknesses_of(ring.model, {}).none());
    // Three cameras of photographs of one size, one of them far off.
    camera.params[0] /= 8.0;
    camera.focal_source = FocalSource::kEstimated;
    ring.model.cameras[CameraId{7}] = ring.model.cameras[CameraId{8}] = camera;
    EXPECT_TRUE(weaknesses_of(ring.model, {}).none());
    ring.model.cameras[CameraId{8}].params[0] *= 1.8;
    EXPECT_EQ(list_of(weaknesses_of(ring.model, {})), std::vector{Weakness::kImplausibleFocal});
}

}  // namespace
}  // namespace psfm
