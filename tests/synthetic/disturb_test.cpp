// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/disturb.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/synthetic/verified_pairs.h"

namespace psfm::synthetic {
namespace {

TEST(AddPixelNoise, HasTheSizeAskedForAndTouchesNothingElse) {
    const SyntheticScene exact = make_scene(ring_around_sphere(10), 1);
    const SyntheticScene noisy = add_pixel_noise(exact, 0.7, 1);
    double squares = 0.0;
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < exact.images.size(); ++i) {
        ASSERT_EQ(noisy.images[i].feature_point, exact.images[i].feature_point);
        EXPECT_EQ(noisy.images[i].cam_from_world.translation,
                  exact.images[i].cam_from_world.translation);
        for (std::size_t k = 0; k < exact.images[i].keypoints.size(); ++k) {
            const Eigen::Vector2d offset =
                noisy.images[i].keypoints[k].position() - exact.images[i].keypoints[k].position();
            squares += offset.squaredNorm();
            sum += offset.sum();
            count += 2.0;
        }
    }
    EXPECT_NEAR(std::sqrt(squares / count), 0.7, 0.02);
    EXPECT_NEAR(sum / count, 0.0, 0.03);
}

TEST(AddClutter, AddsFeaturesInTheImageThatMatchNothing) {
    const SyntheticScene clean = make_scene(ring_around_sphere(6), 1);
    const SyntheticScene cluttered = add_clutter(clean, 80, 1);
    for (std::size_t i = 0; i < clean.images.size(); ++i) {
        const SceneImage& image = cluttered.images[i];
        ASSERT_EQ(image.keypoints.size(), clean.images[i].keypoints.size() + 80);
        ASSERT_EQ(image.feature_point.size(), image.keypoints.size());
        EXPECT_EQ(std::ranges::count(image.feature_point, kNoPoint), 80);
        for (const Keypoint& keypoint : image.keypoints) {
            EXPECT_GE(keypoint.x, 0.F);
            EXPECT_LE(keypoint.x, 1000.F);
            EXPECT_GE(keypoint.y, 0.F);
            EXPECT_LE(keypoint.y, 750.F);
        }
    }
}

TEST(GuessedCameras, AreOffInFocalLengthAndKnowNoDistortion) {
    SceneOptions options = ring_around_sphere(200);
    options.points.count = 10;
    options.cameras.shared = false;
    options.cameras.model = CameraModel::kOpenCv;
    const SyntheticScene scene = make_scene(options, 1);
    const auto guesses = guessed_cameras(scene, 0.02, FocalSource::kExif, 1);
    double squares = 0.0;
    for (const auto& [id, truth] : scene.cameras) {
        const Camera& guess = guesses.at(id);
        EXPECT_TRUE(validate(guess).ok());
        EXPECT_EQ(guess.focal_source, FocalSource::kExif);
        EXPECT_EQ(guess.params[4], 0.0);
        EXPECT_EQ(guess.principal_point(), Eigen::Vector2d(500, 375));
        squares += std::pow(guess.fx() / truth.fx() - 1.0, 2);
        EXPECT_NEAR(guess.fy() / guess.fx(), truth.fy() / truth.fx(), 1e-12);
    }
    EXPECT_NEAR(std::sqrt(squares / 200.0), 0.02, 0.004);
}

class WrongMatches : public testing::Test {
  protected:
    SyntheticScene scene_ = add_clutter(make_scene(ring_around_sphere(16), 1), 300, 1);

    bool is_right(ImagePair pair, const FeatureMatch& match) const {
        const std::uint32_t point = scene_.images[index_of(pair.first)].feature_point[match.first];
        return point != kNoPoint &&
               point == scene_.images[index_of(pair.second)].feature_point[match.second];
    }
};

TEST_F(WrongMatches, ComeInTheFractionAskedForAndKeepTheRightOnes) {
    const ImagePair pair{ImageId{0}, ImageId{1}};
    const std::vector<FeatureMatch> right = true_matches(scene_, pair);
    for (const double fraction : {0.0, 0.1, 0.3, 0.5}) {
        const std::vector<FeatureMatch> all =
            add_wrong_matches(scene_, pair, right, {.fraction = fraction}, 7);
        const auto wrong =
            std::ranges::count_if(all, [&](const FeatureMatch& m) { return !is_right(pair, m); });
        EXPECT_NEAR(static_cast<double>(wrong) / static_cast<double>(all.size()), fraction, 0.01);
        EXPECT_TRUE(std::ranges::includes(all, right));
        EXPECT_TRUE(std::ranges::is_sorted(all));
        std::vector<std::uint32_t> firsts;
        std::vector<std::uint32_t> seconds;
        for (const FeatureMatch& match : all) {
            firsts.push_back(match.first);
            seconds.push_back(match.second);
        }
        for (std::vector<std::uint32_t>* side : {&firsts, &seconds}) {
            std::ranges::sort(*side);
            EXPECT_EQ(std::ranges::adjacent_find(*side), side->end()) << "a feature was used twice";
        }
    }
}

TEST_F(WrongMatches, LieNearTheEpipolarLineWhenAsked) {
    const std::vector<VerifiedPairPtr> pairs = make_verified_pairs(scene_);
    const auto disturbed =
        add_wrong_matches(scene_, pairs, {.fraction = 0.15, .max_epipolar_error_px = 2.0}, 7);
    ASSERT_EQ(disturbed.size(), pairs.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const VerifiedPair& pair = *disturbed[i];
        EXPECT_EQ(pair.geometry.matrix, pairs[i]->geometry.matrix);
        const Camera& camera = scene_.cameras.begin()->second;
        for (const FeatureMatch& match : pair.geometry.inliers) {
            if (is_right(pair.pair, match)) continue;
            ++wrong;
            const auto place = [&](ImageId image, std::uint32_t feature) {
                return normalized_from_pixel(
                    camera, scene_.images[index_of(image)].keypoints[feature].position());
            };
            const Eigen::Vector3d line =
                pair.geometry.matrix * place(pair.pair.first, match.first).homogeneous();
            const double distance =
                std::abs(line.dot(place(pair.pair.second, match.second).homogeneous())) /
                line.head<2>().norm();
            EXPECT_LT(distance * camera.fx(), 2.0 + 1e-9);
        }
    }
    EXPECT_GT(wrong, 10 * pairs.size());
}

}  // namespace
}  // namespace psfm::synthetic
