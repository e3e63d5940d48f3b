// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/disturb.h"

#include <algorithm>
#include <cmath>

#include "tests/synthetic/rng.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm::synthetic {
namespace {

/// Normalised coordinates of all features of an image.
std::vector<Eigen::Vector2d> normalized_features(const SceneImage& image, const Camera& camera) {
    std::vector<Eigen::Vector2d> result;
    for (const Keypoint& keypoint : image.keypoints) {
        result.push_back(normalized_from_pixel(camera, keypoint.position()));
    }
    return result;
}

std::vector<std::uint32_t> unmatched(std::size_t features, const std::vector<FeatureMatch>& matches,
                                     std::uint32_t FeatureMatch::*side) {
    std::vector<bool> used(features, false);
    for (const FeatureMatch& match : matches) used[match.*side] = true;
    std::vector<std::uint32_t> free;
    for (std::uint32_t i = 0; i < features; ++i) {
        if (!used[i]) free.push_back(i);
    }
    return free;
}

}  // namespace

SyntheticScene add_pixel_noise(SyntheticScene scene, double sigma_px, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 10));
    for (SceneImage& image : scene.images) {
        for (Keypoint& keypoint : image.keypoints) {
            keypoint.x += static_cast<float>(sigma_px * rng.normal());
            keypoint.y += static_cast<float>(sigma_px * rng.normal());
        }
    }
    return scene;
}

SyntheticScene add_clutter(SyntheticScene scene, std::uint32_t per_image, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 11));
    for (SceneImage& image : scene.images) {
        const Camera& camera = scene.cameras.at(image.camera);
        for (std::uint32_t i = 0; i < per_image; ++i) {
            Keypoint keypoint;
            keypoint.x = static_cast<float>(rng.uniform(0.0, camera.width));
            keypoint.y = static_cast<float>(rng.uniform(0.0, camera.height));
            // Smaller than every other feature, so that the order by scale holds.
            keypoint.scale = 0.1F;
            image.keypoints.push_back(keypoint);
            image.feature_point.push_back(kNoPoint);
        }
    }
    return scene;
}

std::map<CameraId, Camera> guessed_cameras(const SyntheticScene& scene, double relative_focal_sigma,
                                           FocalSource source, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 12));
    std::map<CameraId, Camera> guesses;
    for (const auto& [id, truth] : scene.cameras) {
        Camera guess = truth;
        const double factor = 1.0 + relative_focal_sigma * rng.normal();
        const std::size_t focals = truth.has_two_focals() ? 2 : 1;
        guess.params.fill(0.0);
        for (std::size_t i = 0; i < focals; ++i) guess.params[i] = truth.params[i] * factor;
        guess.params[focals] = 0.5 * truth.width;
        guess.params[focals + 1] = 0.5 * truth.height;
        guess.focal_source = source;
        guesses.emplace(id, guess);
    }
    return guesses;
}

std::vector<FeatureMatch> add_wrong_matches(const SyntheticScene& scene, ImagePair pair,
                                            std::vector<FeatureMatch> matches,
                                            const WrongMatchOptions& options, std::uint64_t seed) {
    Rng rng(mix_seed(mix_seed(mix_seed(seed, 13), index_of(pair.first)), index_of(pair.second)));
    const SceneImage& image1 = scene.images.at(index_of(pair.first));
    const SceneImage& image2 = scene.images.at(index_of(pair.second));
    const Camera& camera1 = scene.cameras.at(image1.camera);
    const Camera& camera2 = scene.cameras.at(image2.camera);
    const Eigen::Matrix3d essential =
        essential_matrix(image2.cam_from_world * inverse(image1.cam_from_world));
    std::vector<std::uint32_t> free1 =
        unmatched(image1.keypoints.size(), matches, &FeatureMatch::first);
    std::vector<std::uint32_t> free2 =
        unmatched(image2.keypoints.size(), matches, &FeatureMatch::second);
    rng.shuffle(free1);
    rng.shuffle(free2);
    const auto right = static_cast<double>(matches.size());
    const auto wanted =
        static_cast<std::size_t>(std::llround(right * options.fraction / (1.0 - options.fraction)));
    std::vector<Eigen::Vector2d> x1;
    std::vector<Eigen::Vector2d> x2;
    if (options.max_epipolar_error_px) {
        x1 = normalized_features(image1, camera1);
        x2 = normalized_features(image2, camera2);
    }
    for (std::size_t made = 0; made < wanted && !free1.empty(); free1.pop_back()) {
        const std::uint32_t feature1 = free1.back();
        const std::uint32_t point = image1.feature_point[feature1];
        Eigen::Vector3d line = Eigen::Vector3d::Zero();  // epipolar, its normal of length 1
        if (options.max_epipolar_error_px) {
            line = essential * x1[feature1].homogeneous();
            line /= std::max(line.head<2>().norm(), 1e-15);
        }
        const auto partner = std::ranges::find_if(free2, [&](std::uint32_t feature2) {
            if (point != kNoPoint && point == image2.feature_point[feature2]) return false;
            if (!options.max_epipolar_error_px) return true;
            const double distance_px =
                std::abs(line.dot(x2[feature2].homogeneous())) * camera2.mean_focal();
            return distance_px <= *options.max_epipolar_error_px;
        });
        if (partner == free2.end()) continue;
        matches.push_back({feature1, *partner});
        free2.erase(partner);
        ++made;
    }
    std::ranges::sort(matches);
    return matches;
}

std::vector<VerifiedPairPtr> add_wrong_matches(const SyntheticScene& scene,
                                               const std::vector<VerifiedPairPtr>& pairs,
                                               const WrongMatchOptions& options,
                                               std::uint64_t seed) {
    std::vector<VerifiedPairPtr> result;
    for (const VerifiedPairPtr& pair : pairs) {
        VerifiedPair disturbed = *pair;
        disturbed.geometry.inliers = add_wrong_matches(
            scene, pair->pair, std::move(disturbed.geometry.inliers), options, seed);
        result.push_back(std::make_shared<const VerifiedPair>(std::move(disturbed)));
    }
    return result;
}

}  // namespace psfm::synthetic
