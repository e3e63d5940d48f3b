// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/two_view_problem.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "stages/algorithms/two_view/decompose_two_view.h"

namespace psfm {
namespace {

/// Pixel of the pinhole camera that is left when distortion is removed.
Eigen::Vector2d pinhole_pixel(const Camera& camera, const Eigen::Vector2d& normalized) {
    return camera.principal_point() +
           Eigen::Vector2d(camera.fx() * normalized.x(), camera.fy() * normalized.y());
}

template <typename Agrees>
Indices select_if(std::size_t count, const Agrees& agrees) {
    Indices indices;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (agrees(i)) indices.push_back(i);
    }
    return indices;
}

/// Distance [px] of a turned ray's image from a point; infinite behind the camera.
double transfer_error(const Eigen::Matrix3d& intrinsic, const Eigen::Vector3d& ray,
                      const Eigen::Vector2d& pixel) {
    if (ray.z() <= 0) return std::numeric_limits<double>::infinity();
    const Eigen::Vector3d image = intrinsic * ray;
    return (image.head<2>() / image.z() - pixel).norm();
}

}  // namespace

Result<TwoViewProblem> make_two_view_problem(const MatchedViews& views, double max_error_px) {
    for (const Camera* camera : {&views.camera1, &views.camera2}) {
        if (const Result<void> valid = validate(*camera); !valid.ok()) return valid.error();
    }
    TwoViewProblem problem;
    problem.intrinsics = {views.camera1.matrix(), views.camera2.matrix()};
    problem.cheirality_slack =
        max_error_px * (1 / views.camera1.mean_focal() + 1 / views.camera2.mean_focal());
    problem.calibrated = views.camera1.focal_source != FocalSource::kUnknown &&
                         views.camera2.focal_source != FocalSource::kUnknown;
    std::vector<FeatureMatch> matches(views.matches.begin(), views.matches.end());
    std::ranges::sort(matches);
    for (const FeatureMatch& match : matches) {
        if (match.first >= views.keypoints1.size() || match.second >= views.keypoints2.size()) {
            return Error{ErrorCode::kInvalidArgument,
                         "match of features " + std::to_string(match.first) + " and " +
                             std::to_string(match.second) +
                             " names a feature that its image does not have"};
        }
        const PointPair normalized{
            normalized_from_pixel(views.camera1, views.keypoints1[match.first].position()),
            normalized_from_pixel(views.camera2, views.keypoints2[match.second].position())};
        if (!normalized.x1.allFinite() || !normalized.x2.allFinite()) continue;
        problem.matches.push_back(match);
        problem.normalized.push_back(normalized);
        problem.pixels.push_back({pinhole_pixel(views.camera1, normalized.x1),
                                  pinhole_pixel(views.camera2, normalized.x2)});
    }
    return problem;
}

Indices inliers_of_fundamental(const TwoViewProblem& problem, const Eigen::Matrix3d& f,
                               double max_error_px) {
    return select_if(problem.matches.size(), [&](std::uint32_t i) {
        return std::abs(sampson_residual(f, problem.pixels[i])) <= max_error_px;
    });
}

Indices inliers_of_pose(const TwoViewProblem& problem, const Rigid3& cam2_from_cam1,
                        double max_error_px) {
    const Eigen::Matrix3d f = fundamental_from_pose(cam2_from_cam1, problem.intrinsics);
    const RayMeeting meeting(cam2_from_cam1);
    return select_if(problem.matches.size(), [&](std::uint32_t i) {
        return std::abs(sampson_residual(f, problem.pixels[i])) <= max_error_px &&
               meeting.passes_cheirality(problem.normalized[i], problem.cheirality_slack);
    });
}

Indices inliers_of_rotation(const TwoViewProblem& problem, const Eigen::Quaterniond& rotation,
                            double max_error_px) {
    const Eigen::Matrix3d forward = rotation.toRotationMatrix();
    return select_if(problem.matches.size(), [&](std::uint32_t i) {
        const Eigen::Vector3d ray2 = forward * problem.normalized[i].x1.homogeneous();
        const Eigen::Vector3d ray1 = forward.transpose() * problem.normalized[i].x2.homogeneous();
        return transfer_error(problem.intrinsics.k2, ray2, problem.pixels[i].x2) <= max_error_px &&
               transfer_error(problem.intrinsics.k1, ray1, problem.pixels[i].x1) <= max_error_px;
    });
}

std::vector<PointPair> select(std::span<const PointPair> points,
                              std::span<const std::uint32_t> indices) {
    std::vector<PointPair> selected;
    selected.reserve(indices.size());
    for (const std::uint32_t i : indices) selected.push_back(points[i]);
    return selected;
}

std::vector<FeatureMatch> feature_matches(const TwoViewProblem& problem,
                                          std::span<const std::uint32_t> indices) {
    std::vector<FeatureMatch> matches;
    matches.reserve(indices.size());
    std::uint32_t last = 0;
    for (const std::uint32_t i : indices)
        last = std::max({last, problem.matches[i].first, problem.matches[i].second});
    std::vector<bool> seen1(std::size_t{last} + 1, false);
    std::vector<bool> seen2(std::size_t{last} + 1, false);
    for (const std::uint32_t i : indices) {
        const FeatureMatch& match = problem.matches[i];
        if (seen1[match.first] || seen2[match.second]) continue;
        seen1[match.first] = seen2[match.second] = true;
        matches.push_back(match);
    }
    return matches;
}

}  // namespace psfm
