// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/observation_noise.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <utility>

#include "stages/reconstruction/build/refine_model.h"
#include "stages/reconstruction/model/solve_options.h"
#include "tests/stages/reconstruction/scene_model.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/disturb.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

/// A wall whose features are off by `sigma_px`, and every `nth` of them by `pixels` to the right.
SyntheticScene wall_with_wrong_features(double sigma_px, std::size_t nth, float pixels) {
    SyntheticScene scene = synthetic::add_pixel_noise(
        synthetic::make_scene(synthetic::line_along_wall(12), 3), sigma_px, 4);
    std::size_t number = 0;
    for (synthetic::SceneImage& image : scene.images) {
        for (Keypoint& keypoint : image.keypoints) {
            if (nth > 0 && number++ % nth == 0) keypoint.x += pixels;
        }
    }
    return scene;
}

/// As settling does, with these bounds.
SceneModel settled(SyntheticScene scene, const NoiseBounds& bounds) {
    SceneModel wall(std::move(scene));
    SolveOptions options;
    options.settling.noise = bounds;
    EXPECT_TRUE(refine_model(*wall.model, options.settling, {.options = options}).ok());
    return wall;
}

TEST(ObservationNoise, IsThatOfTheFeaturesWhateverSomeAreOffBy) {
    const AdjustmentOptions options{.sigma_per_scale = 0.0};
    for (const double sigma : {0.05, 0.3}) {
        SCOPED_TRACE(sigma);
        const SceneModel wall = settled(wall_with_wrong_features(sigma, 20, 3.0F), {});
        EXPECT_NEAR(observation_noise(*wall.model, options), sigma, 0.25 * sigma);
    }
}

TEST(ObservationNoise, ALossIsNarrowedAndNeverWidened) {
    const SceneModel wall = settled(wall_with_wrong_features(0.05, 0, 0.0F), {});
    AdjustmentOptions options{.sigma_per_scale = 0.0};
    const NoiseBounds bounds{.loss = 3.0, .max_error = 12.0};
    EXPECT_NEAR(fitted_to_noise(*wall.model, options, bounds).loss_scale_px, 0.15, 0.04);
    EXPECT_EQ(fitted_to_noise(*wall.model, options, {}).loss_scale_px, options.loss_scale_px);
    EXPECT_EQ(max_error_by_noise(*wall.model, options, bounds, 4.0), 1.0) << "for large features";
    EXPECT_EQ(max_error_by_noise(*wall.model, options, bounds, 0.5), 0.5);
    EXPECT_EQ(max_error_by_noise(*wall.model, options, {}, 4.0), 4.0);
    options.loss_scale_px = 0.1;
    EXPECT_EQ(fitted_to_noise(*wall.model, options, bounds).loss_scale_px, 0.1);
}

TEST(ObservationNoise, ExactFeaturesAreNotBentByWrongOnes) {
    const auto error_with = [](const NoiseBounds& bounds) {
        const SceneModel wall = settled(wall_with_wrong_features(0.03, 15, 1.5F), bounds);
        const auto error = synthetic::compare_with_truth(wall.model->save(), wall.scene);
        EXPECT_TRUE(error.ok());
        return error.ok() ? error->mean_position : 1e9;
    };
    const double bent = error_with({});
    EXPECT_LT(error_with(SolveOptions{}.settling.noise), 0.5 * bent);
}

}  // namespace
}  // namespace psfm
