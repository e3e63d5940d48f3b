// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "graph/camera.h"
#include "graph/image.h"
#include "graph/rigid3.h"
#include "stages/verification/two_view_problem.h"
#include "tests/synthetic/rng.h"

namespace psfm::test {

enum class Shape { kVolume, kPlane, kLine };

struct TwoViewOptions {
    Shape shape = Shape::kVolume;
    int matches = 400;
    double wrong = 0.3;  ///< part of the matches that is wrong
    double noise_px = 0.5;
    bool turn_only = false;
    Camera camera1 = make_camera(1500, 1000, 1400, FocalSource::kGiven);
    Camera camera2 = make_camera(1500, 1000, 1400, FocalSource::kGiven);
};

/// Two views of one shape, made with the cameras of the options.
struct TwoViews {
    Keypoints keypoints1;
    Keypoints keypoints2;
    std::vector<FeatureMatch> matches;
    std::vector<bool> is_true;  ///< by match
    Camera camera1;
    Camera camera2;
    Rigid3 cam2_from_cam1;  ///< the truth, |translation| = 1 or 0

    MatchedViews matched() const { return {keypoints1, keypoints2, camera1, camera2, matches}; }
};

inline Keypoint keypoint_at(const Eigen::Vector2d& position) {
    Keypoint keypoint;
    keypoint.x = static_cast<float>(position.x());
    keypoint.y = static_cast<float>(position.y());
    keypoint.scale = 2.F;
    return keypoint;
}

inline Eigen::Vector3d point_of(Shape shape, synthetic::Rng& rng) {
    switch (shape) {
        case Shape::kVolume: {
            const double x = rng.uniform(-3, 3);
            const double y = rng.uniform(-2, 2);
            return {x, y, rng.uniform(5, 10)};
        }
        case Shape::kPlane: {
            const double x = rng.uniform(-3, 3);
            const double y = rng.uniform(-2, 2);
            return {x, y, 7 + 0.5 * x - 0.3 * y};
        }
        case Shape::kLine: {
            const double along = rng.uniform(-1, 1);
            return {3 * along, along, 7 + along};
        }
    }
    return Eigen::Vector3d::UnitZ();
}

inline TwoViews make_two_views(const TwoViewOptions& options, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    TwoViews views;
    views.camera1 = options.camera1;
    views.camera2 = options.camera2;
    views.cam2_from_cam1.rotation =
        Eigen::AngleAxisd(0.2, Eigen::Vector3d(0.2, 1, 0.1).normalized());
    const Eigen::Vector3d baseline(-1.5, 0.2, 0.3);
    Rigid3 pose = views.cam2_from_cam1;
    if (!options.turn_only) {
        pose.translation = baseline;
        views.cam2_from_cam1.translation = baseline.normalized();
    }
    const auto anywhere = [&](const Camera& camera) {
        const double x = rng.uniform(0, camera.width);
        return Eigen::Vector2d(x, rng.uniform(0, camera.height));
    };
    const auto noise = [&]() -> Eigen::Vector2d {
        const double x = rng.normal();
        return Eigen::Vector2d(x, rng.normal()) * options.noise_px;
    };
    while (views.matches.size() < static_cast<std::size_t>(options.matches)) {
        const Eigen::Vector3d point = point_of(options.shape, rng);
        const auto pixel1 = project(options.camera1, point);
        const auto pixel2 = project(options.camera2, pose * point);
        if (!pixel1 || !pixel2) continue;
        const bool is_true = rng.uniform() >= options.wrong;
        const auto index = static_cast<std::uint32_t>(views.matches.size());
        views.keypoints1.push_back(keypoint_at(*pixel1 + noise()));
        views.keypoints2.push_back(
            keypoint_at(is_true ? Eigen::Vector2d(*pixel2 + noise()) : anywhere(options.camera2)));
        views.matches.push_back({index, index});
        views.is_true.push_back(is_true);
    }
    return views;
}

inline double degrees(double radians) {
    return radians * 180.0 / std::numbers::pi;
}

inline double rotation_error_deg(const Rigid3& estimate, const Rigid3& truth) {
    return degrees(angle_between(estimate.rotation, truth.rotation));
}

inline double direction_error_deg(const Rigid3& estimate, const Rigid3& truth) {
    const double cosine = estimate.translation.normalized().dot(truth.translation.normalized());
    return degrees(std::acos(std::clamp(cosine, -1.0, 1.0)));
}

/// Inliers of the geometry that are wrong matches.
inline std::size_t wrong_inliers(const TwoViews& views, const std::vector<FeatureMatch>& inliers) {
    return static_cast<std::size_t>(std::ranges::count_if(
        inliers, [&](const FeatureMatch& match) { return !views.is_true[match.first]; }));
}

inline std::size_t true_count(const TwoViews& views) {
    return static_cast<std::size_t>(std::ranges::count(views.is_true, true));
}

}  // namespace psfm::test
