// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What becomes of intrinsics that an adjustment takes to where no photograph's are.
#include <gtest/gtest.h>

#include "stages/reconstruction/adjust/bundle_adjustment.h"
#include "tests/stages/reconstruction/scene_model.h"
#include "tests/synthetic/disturb.h"

namespace psfm {
namespace {

constexpr double kFocal = 7000.0;  // of photographs of 1000 px: a view of eight degrees

/// A ring of photographs with a long lens, their model as it is for another focal length: all
/// cameras nearer by as much as that is shorter.
struct LongLens : SceneModel {
    explicit LongLens(double believed_focal) : SceneModel(scene_with_long_lens()) {
        const double nearer = believed_focal / kFocal;
        const CameraId camera = model->cameras().begin()->first;
        model->mutable_camera(camera).params[0] = believed_focal;
        for (std::uint32_t image = 0; image < model->image_count(); ++image) {
            Rigid3 pose = model->pose(image);
            pose.translation.z() *= nearer;
            model->set_pose(image, pose);
        }
    }

    static synthetic::SyntheticScene scene_with_long_lens() {
        synthetic::SceneOptions options = synthetic::ring_around_sphere(12);
        options.cameras.focal_px = kFocal;
        options.cameras.radius *= kFocal / 900.0;
        options.cameras.turn_sigma_deg = 0.3;
        options.cameras.k1 = 0.0;
        return synthetic::add_pixel_noise(synthetic::make_scene(options, 1), 0.3, 2);
    }

    /// Focal length after an adjustment of all, of the error that is left.
    double adjusted_focal(double most_rms_px) const {
        AdjustmentOptions options;
        options.function_tolerance = 1e-10;
        options.max_iterations = 200;
        const auto report = adjust(*model, full_scope(*model, true), options);
        EXPECT_TRUE(report.ok());
        EXPECT_LT(report.ok() ? report->rms_after_px : 1e9, most_rms_px);
        return model->cameras().begin()->second.fx();
    }
};

TEST(Adjust, AFocalLengthThatRunsAwayStaysWhereItWas) {
    EXPECT_EQ(LongLens(5000.0).adjusted_focal(2.0), 5000.0);
}

TEST(Adjust, AFocalLengthThatWasKnownToBeLongIsRefined) {
    EXPECT_NEAR(LongLens(6300.0).adjusted_focal(0.6), kFocal, 0.03 * kFocal);
}

}  // namespace
}  // namespace psfm
