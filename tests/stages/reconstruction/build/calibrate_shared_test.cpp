// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/calibrate_shared.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

/// A ring of 40 images of one camera whose focal length is believed to be 4 per cent too long, and
/// whose distortion is not known.
class CalibrateShared : public testing::Test {
  protected:
    CalibrateShared() {
        synthetic::SceneOptions options = synthetic::ring_around_sphere(40);
        options.visibility.max_features = 150;
        options.cameras.k1 = -0.1;
        scene_ = synthetic::add_pixel_noise(synthetic::make_scene(options, 1), 0.3, 2);
        believed_ = scene_.cameras;
        for (auto& [id, camera] : believed_) {
            camera =
                make_camera(camera.width, camera.height, 1.04 * camera.fx(), FocalSource::kExif);
        }
        make_problem();
    }

    void make_problem() {
        problem_ = problem_of(scene_, synthetic::make_verified_pairs(scene_), believed_,
                              scene_.images.size());
        graph_.cameras = believed_;
        graph_.pairs = pairs_of(problem_);
    }

    std::map<CameraId, Camera> calibrate(const SolveOptions& options = {}) const {
        const auto calibrated = calibrate_shared_cameras(problem_, graph_, options, nullptr);
        EXPECT_TRUE(calibrated.ok());
        return calibrated.ok() ? *calibrated : std::map<CameraId, Camera>{};
    }

    double median_rotation_error_deg(const std::vector<VerifiedPairPtr>& pairs) const {
        std::vector<double> errors;
        for (const VerifiedPairPtr& pair : pairs) {
            const Rigid3 truth = scene_.images[index_of(pair->pair.second)].cam_from_world *
                                 inverse(scene_.images[index_of(pair->pair.first)].cam_from_world);
            errors.push_back(angle_between(pair->geometry.cam2_from_cam1.rotation, truth.rotation) *
                             180.0 / std::numbers::pi);
        }
        std::ranges::sort(errors);
        return errors.at(errors.size() / 2);
    }

    SyntheticScene scene_;
    std::map<CameraId, Camera> believed_;
    ClusterProblem problem_;
    LocalGraph graph_;
};

TEST_F(CalibrateShared, FindsFocalLengthAndDistortion) {
    const auto calibrated = calibrate();
    ASSERT_EQ(calibrated.size(), 1U);
    const Camera& truth = scene_.cameras.begin()->second;
    const Camera& found = calibrated.begin()->second;
    EXPECT_NEAR(found.fx(), truth.fx(), 0.01 * truth.fx());
    EXPECT_NEAR(found.params[3], truth.params[3], 0.02);
}

TEST_F(CalibrateShared, StraightensThePairs) {
    const auto bent = pairs_seen_through(believed_, problem_, graph_, {});
    EXPECT_EQ(bent.size(), graph_.pairs.size());
    graph_.pairs = bent;
    const auto straight = pairs_seen_through(calibrate(), problem_, graph_, {});
    EXPECT_EQ(straight.size(), graph_.pairs.size());
    EXPECT_LT(median_rotation_error_deg(straight), 0.5 * median_rotation_error_deg(bent));
}

TEST_F(CalibrateShared, LeavesAloneWhatIsKnownOrCannotBe) {
    SolveOptions options;
    options.global.images_to_calibrate = 41;
    EXPECT_TRUE(calibrate(options).empty());
    problem_.fix_intrinsics = true;
    EXPECT_TRUE(calibrate().empty());
    problem_.fix_intrinsics = false;
    for (const FocalSource source : {FocalSource::kGiven, FocalSource::kEstimated}) {
        for (auto& [id, camera] : graph_.cameras) camera.focal_source = source;
        EXPECT_TRUE(calibrate().empty());
    }
    graph_.pairs.clear();
    for (auto& [id, camera] : graph_.cameras) camera.focal_source = FocalSource::kExif;
    EXPECT_TRUE(calibrate().empty());
}

TEST_F(CalibrateShared, TurnedPhotographsTellTheLensOfTheFewOthers) {
    constexpr CameraId kOwner{77};
    constexpr CameraId kOther{78};
    const auto [twin, truth] = *scene_.cameras.begin();
    for (const CameraId few : {kOwner, kOther}) {
        scene_.cameras[few] = truth;
        believed_[few] = believed_.at(twin);
    }
    scene_.images[0].camera = scene_.images[1].camera = kOwner;
    scene_.images[2].camera = kOther;
    make_problem();
    EXPECT_EQ(calibrate().size(), 1U) << "too few of the others";
    problem_.twins = {{twin, kOwner}, {kOther, kOwner}};
    const auto calibrated = calibrate();
    ASSERT_EQ(calibrated.size(), 3U);
    EXPECT_NEAR(calibrated.at(twin).fx(), truth.fx(), 0.01 * truth.fx());
    EXPECT_EQ(calibrated.at(kOwner).params, calibrated.at(twin).params);
    EXPECT_EQ(calibrated.at(kOther).params, calibrated.at(twin).params);

    graph_.cameras.at(kOwner).focal_source = FocalSource::kGiven;
    EXPECT_FALSE(calibrate().contains(kOwner));
}

TEST_F(CalibrateShared, StopsOnRequest) {
    const std::atomic<bool> cancel{true};
    const auto calibrated = calibrate_shared_cameras(problem_, graph_, {}, &cancel);
    ASSERT_FALSE(calibrated.ok());
    EXPECT_EQ(calibrated.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace psfm
