// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/match_density.h"

#include <Eigen/LU>
#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace psfm {
namespace {

/// y ~ linear * x + shift, least squares; a slight pull towards a pure shift keeps matches along a
/// line harmless.
struct AffineMap {
    Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();

    Eigen::Vector2d operator()(const Eigen::Vector2d& x) const { return linear * x + shift; }
};

AffineMap fit_affine(const std::vector<Eigen::Vector2d>& from,
                     const std::vector<Eigen::Vector2d>& to) {
    Eigen::Vector2d from_mean = Eigen::Vector2d::Zero();
    Eigen::Vector2d to_mean = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
        from_mean += from[i];
        to_mean += to[i];
    }
    from_mean /= static_cast<double>(from.size());
    to_mean /= static_cast<double>(from.size());
    // Normal equations of the deviation from a pure shift.
    Eigen::Matrix2d normal = Eigen::Matrix2d::Identity();
    Eigen::Matrix2d right = Eigen::Matrix2d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
        const Eigen::Vector2d x = from[i] - from_mean;
        const Eigen::Vector2d y = to[i] - to_mean;
        normal += x * x.transpose();
        right += (y - x) * x.transpose();
    }
    AffineMap map;
    map.linear += right * normal.inverse();
    map.shift = to_mean - map.linear * from_mean;
    return map;
}

std::size_t count_inside(std::span<const Keypoint> keypoints, const AffineMap& map,
                         const Camera& camera) {
    const Eigen::Array2d size(camera.width, camera.height);
    return static_cast<std::size_t>(std::ranges::count_if(keypoints, [&](const Keypoint& keypoint) {
        const Eigen::Array2d there = map(keypoint.position()).array();
        return (there >= 0.0).all() && (there <= size).all();
    }));
}

std::size_t count_in_hull(std::span<const Keypoint> keypoints,
                          const std::vector<Eigen::Vector2d>& matched) {
    std::vector<cv::Point2f> points;
    points.reserve(matched.size());
    for (const Eigen::Vector2d& point : matched)
        points.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()));
    std::vector<cv::Point2f> hull;  // counter-clockwise, where y points up
    cv::convexHull(points, hull);
    const auto [left, right] = std::ranges::minmax(hull, {}, &cv::Point2f::x);
    const auto [top, bottom] = std::ranges::minmax(hull, {}, &cv::Point2f::y);
    const auto is_beside = [](const cv::Point2f& a, const cv::Point2f& b, const Keypoint& point) {
        return (double{b.x} - a.x) * (double{point.y} - a.y) <
               (double{b.y} - a.y) * (double{point.x} - a.x);
    };
    return static_cast<std::size_t>(std::ranges::count_if(keypoints, [&](const Keypoint& keypoint) {
        if (keypoint.x < left.x || keypoint.x > right.x || keypoint.y < top.y ||
            keypoint.y > bottom.y || is_beside(hull.back(), hull.front(), keypoint))
            return false;
        for (std::size_t i = 1; i < hull.size(); ++i) {
            if (is_beside(hull[i - 1], hull[i], keypoint)) return false;
        }
        return true;
    }));
}

}  // namespace

MatchDensity match_density(const MatchedViews& views, std::span<const FeatureMatch> inliers) {
    if (inliers.empty()) return {};
    std::vector<Eigen::Vector2d> first;
    std::vector<Eigen::Vector2d> second;
    for (const FeatureMatch& match : inliers) {
        first.push_back(views.keypoints1[match.first].position());
        second.push_back(views.keypoints2[match.second].position());
    }
    const auto density = [&](std::size_t in_first, std::size_t in_second) {
        const std::size_t could_match = std::max(std::min(in_first, in_second), inliers.size());
        return static_cast<double>(inliers.size()) / static_cast<double>(could_match);
    };
    return {
        density(count_inside(views.keypoints1, fit_affine(first, second), views.camera2),
                count_inside(views.keypoints2, fit_affine(second, first), views.camera1)),
        density(count_in_hull(views.keypoints1, first), count_in_hull(views.keypoints2, second))};
}

}  // namespace psfm
