// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/focal/calibrate_focals.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "stages/algorithms/focal/refine_focals.h"
#include "stages/verification/verify_pair.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/scene.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

/// Photographs of a ball from around it, their pairs verified with a focal length a third too long.
struct Session {
    std::vector<VerifiedPairPtr> pairs;
    std::map<CameraId, Camera> cameras;
    std::map<ImageId, CameraId> camera_of;
    std::map<CameraId, double> true_focal_px;
    synthetic::SyntheticScene scene;

    KeypointsOf keypoints() const {
        return [this](ImageId id) -> std::span<const Keypoint> {
            return scene.images[index_of(id)].keypoints;
        };
    }
};

struct SessionOptions {
    bool shared = true;
    double noise_px = 0.5;
    double wrong = 0.0;  ///< part of wrong matches along epipolar lines
    double turn_sigma_deg = 5.0;
};

Session make_session(const SessionOptions& options) {
    synthetic::SceneOptions scene_options = synthetic::ring_around_sphere(10);
    scene_options.cameras.model = CameraModel::kSimplePinhole;
    scene_options.cameras.shared = options.shared;
    scene_options.cameras.turn_sigma_deg = options.turn_sigma_deg;
    scene_options.visibility.max_features = 400;
    Session session;
    session.scene =
        add_clutter(add_pixel_noise(make_scene(scene_options, 11), options.noise_px, 12), 100, 13);
    for (const auto& [id, camera] : session.scene.cameras) {
        session.true_focal_px[id] = camera.fx();
        session.cameras[id] =
            make_camera(camera.width, camera.height, 1.2 * camera.width, FocalSource::kUnknown);
    }
    for (std::uint32_t i = 0; i < session.scene.images.size(); ++i) {
        session.camera_of[ImageId{i}] = session.scene.images[i].camera;
        for (std::uint32_t j = i + 1; j < session.scene.images.size(); ++j) {
            const ImagePair pair{ImageId{i}, ImageId{j}};
            const auto matches = add_wrong_matches(
                session.scene, pair, true_matches(session.scene, pair), {options.wrong, 2.0}, 14);
            const auto& image1 = session.scene.images[i];
            const auto& image2 = session.scene.images[j];
            const auto geometry =
                verify_pair({image1.keypoints, image2.keypoints, session.cameras.at(image1.camera),
                             session.cameras.at(image2.camera), matches},
                            {}, 15);
            if (geometry.ok()) {
                session.pairs.push_back(
                    std::make_shared<const VerifiedPair>(VerifiedPair{pair, *geometry}));
            }
        }
    }
    return session;
}

/// Largest relative error of the cameras that were calibrated.
double largest_error(const Session& session, const FocalCalibration& calibration) {
    double largest = 0.0;
    for (const auto& [id, focal] : calibration.focals) {
        largest = std::max(largest, std::abs(focal.focal_px / session.true_focal_px.at(id) - 1));
    }
    return largest;
}

TEST(CalibrateFocals, OneSharedCamera) {
    const Session session = make_session({});
    ASSERT_GE(session.pairs.size(), 15U);
    const auto calibration = calibrate_focals(session.pairs, session.cameras, session.camera_of, {},
                                              session.keypoints());
    ASSERT_TRUE(calibration.ok()) << calibration.error().message;
    ASSERT_EQ(calibration->focals.size(), 1U);
    EXPECT_LT(largest_error(session, *calibration), 0.02);
    EXPECT_GE(calibration->focals.begin()->second.pairs, 10U);
    EXPECT_LT(calibration->focals.begin()->second.uncertainty, 0.05);
}

TEST(CalibrateFocals, WrongMatchesAreSurvived) {
    SessionOptions options;
    options.wrong = 0.3;
    const Session session = make_session(options);
    const auto calibration = calibrate_focals(session.pairs, session.cameras, session.camera_of, {},
                                              session.keypoints());
    ASSERT_TRUE(calibration.ok());
    ASSERT_EQ(calibration->focals.size(), 1U);
    EXPECT_LT(largest_error(session, *calibration), 0.03);
}

TEST(CalibrateFocals, WithoutKeypointsTheVotesAloneComeClose) {
    const Session session = make_session({});
    const auto calibration =
        calibrate_focals(session.pairs, session.cameras, session.camera_of, {});
    ASSERT_TRUE(calibration.ok());
    ASSERT_EQ(calibration->focals.size(), 1U);
    EXPECT_LT(largest_error(session, *calibration), 0.1);
}

TEST(CalibrateFocals, ACameraForEachPhotograph) {
    SessionOptions options;
    options.shared = false;
    const Session session = make_session(options);
    const auto calibration = calibrate_focals(session.pairs, session.cameras, session.camera_of, {},
                                              session.keypoints());
    ASSERT_TRUE(calibration.ok());
    ASSERT_EQ(calibration->focals.size(), session.cameras.size());
    // Of inliers within 3 px; with 2 px, the tolerance where a focal length is known, 0.06.
    EXPECT_LT(largest_error(session, *calibration), 0.08);
}

TEST(CalibrateFocals, KnownCamerasAreHeldAndLeftOut) {
    SessionOptions options;
    options.shared = false;
    Session session = make_session(options);
    // Half of the cameras become known after the fact: matrices in undistorted pixels stay valid.
    for (auto& [id, camera] : session.cameras) {
        if (index_of(id) % 2 == 0) continue;
        camera.params[0] = session.true_focal_px.at(id);
        camera.focal_source = FocalSource::kExif;
    }
    const auto calibration = calibrate_focals(session.pairs, session.cameras, session.camera_of, {},
                                              session.keypoints());
    ASSERT_TRUE(calibration.ok());
    EXPECT_EQ(calibration->focals.size(), session.cameras.size() / 2);
    EXPECT_FALSE(calibration->focals.contains(CameraId{1}));
    EXPECT_LT(largest_error(session, *calibration), 0.06);
}

TEST(CalibrateFocals, OrderOfPairsDoesNotMatterAndResultsRepeat) {
    Session session = make_session({});
    const auto once = calibrate_focals(session.pairs, session.cameras, session.camera_of, {},
                                       session.keypoints());
    std::ranges::reverse(session.pairs);
    const auto again = calibrate_focals(session.pairs, session.cameras, session.camera_of, {},
                                        session.keypoints());
    ASSERT_TRUE(once.ok() && again.ok());
    EXPECT_EQ(once->focals.at(CameraId{0}).focal_px, again->focals.at(CameraId{0}).focal_px);
}

TEST(CalibrateFocals, WithoutEvidenceCamerasStayAtTheirGuess) {
    Session session = make_session({});
    const auto none =
        calibrate_focals({}, session.cameras, session.camera_of, {}, session.keypoints());
    ASSERT_TRUE(none.ok());
    EXPECT_TRUE(none->focals.empty());

    std::vector<VerifiedPairPtr> planar;
    for (const VerifiedPairPtr& pair : session.pairs) {
        VerifiedPair copy = *pair;
        copy.geometry.kind = TwoViewKind::kPlanar;
        planar.push_back(std::make_shared<const VerifiedPair>(std::move(copy)));
    }
    const auto skipped =
        calibrate_focals(planar, session.cameras, session.camera_of, {}, session.keypoints());
    ASSERT_TRUE(skipped.ok());
    EXPECT_TRUE(skipped->focals.empty());
    EXPECT_EQ(skipped->pairs, 0U);
}

TEST(CalibrateFocals, CamerasOfAnotherSizeWithoutPairsAreLeftAlone) {
    Session session = make_session({});
    session.cameras[CameraId{9}] = make_camera(640, 480, 768, FocalSource::kUnknown);
    const auto calibration = calibrate_focals(session.pairs, session.cameras, session.camera_of, {},
                                              session.keypoints());
    ASSERT_TRUE(calibration.ok());
    EXPECT_TRUE(calibration->focals.contains(CameraId{0}));
    EXPECT_FALSE(calibration->focals.contains(CameraId{9}));
}

TEST(CalibrateFocals, NamesBadOptionsAndCameras) {
    Session session = make_session({});
    FocalCalibrationOptions options;
    options.spread = 0;
    EXPECT_EQ(
        calibrate_focals(session.pairs, session.cameras, session.camera_of, options).error().code,
        ErrorCode::kInvalidArgument);
    session.cameras.begin()->second.width = 0;
    EXPECT_EQ(calibrate_focals(session.pairs, session.cameras, session.camera_of, {}).error().code,
              ErrorCode::kInvalidArgument);
}

TEST(RefineFocals, StaysAtAnExactSolution) {
    SessionOptions options;
    options.noise_px = 0.0;
    const Session session = make_session(options);
    const double truth_px = session.true_focal_px.at(CameraId{0});
    std::vector<FocalPair> pairs;
    for (const VerifiedPairPtr& pair : session.pairs) {
        FocalPair focal_pair;
        focal_pair.end1.parameter = focal_pair.end2.parameter = 0;
        const Camera& camera = session.scene.cameras.at(CameraId{0});
        const auto offset = [&](ImageId image, std::uint32_t feature) -> Eigen::Vector2d {
            return (session.scene.images[index_of(image)].keypoints[feature].position() -
                    camera.principal_point()) /
                   1000.0;
        };
        for (const FeatureMatch& match : pair->geometry.inliers) {
            focal_pair.points.push_back(
                {offset(pair->pair.first, match.first), offset(pair->pair.second, match.second)});
        }
        const Rigid3 pose =
            session.scene.images[index_of(pair->pair.second)].cam_from_world *
            inverse(session.scene.images[index_of(pair->pair.first)].cam_from_world);
        const Eigen::Matrix3d k = Eigen::Vector3d(truth_px / 1000, truth_px / 1000, 1).asDiagonal();
        focal_pair.fundamental =
            fundamental_from_pose({pose.rotation, pose.translation.normalized()}, {k, k});
        pairs.push_back(std::move(focal_pair));
    }
    const Eigen::VectorXd truth = Eigen::VectorXd::Constant(1, std::log(truth_px / 1000));
    FocalRefinementOptions refinement;
    refinement.loss_scale = 0.5e-3;
    const FocalEstimate estimate = refine_focals(
        pairs, {truth, poses_of(pairs, truth, refinement), {}}, {truth, 0.1}, refinement);
    EXPECT_NEAR(estimate.log_focals[0], truth[0], 1e-4);
    EXPECT_LT(estimate.uncertainty[0], 0.05);
}

}  // namespace
}  // namespace psfm
