// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/two_view/decompose_two_view.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/decompositions.h"
#include "stages/algorithms/math/median.h"

namespace psfm {
namespace {

/// Orthogonal factors with determinant 1 (their sign is free in what follows).
Eigen::Matrix3d proper(const Eigen::Matrix3d& m) {
    return m.determinant() < 0 ? Eigen::Matrix3d(-m) : m;
}

}  // namespace

std::vector<Rigid3> poses_from_essential(const Eigen::Matrix3d& essential) {
    const SingularValues svd = singular_values(essential);
    const Eigen::Matrix3d u = proper(svd.u);
    const Eigen::Matrix3d v = proper(svd.v);
    Eigen::Matrix3d w;
    w << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    const Eigen::Quaterniond first(Eigen::Matrix3d(u * w * v.transpose()));
    const Eigen::Quaterniond second(Eigen::Matrix3d(u * w.transpose() * v.transpose()));
    const Eigen::Vector3d direction = u.col(2);
    return {{first, direction}, {first, -direction}, {second, direction}, {second, -direction}};
}

std::vector<Rigid3> poses_from_homography(const Eigen::Matrix3d& h) {
    std::vector<Rigid3> poses;
    try {
        cv::Mat homography;
        cv::eigen2cv(h, homography);
        std::vector<cv::Mat> rotations;
        std::vector<cv::Mat> translations;
        std::vector<cv::Mat> normals;
        cv::decomposeHomographyMat(homography, cv::Mat::eye(3, 3, CV_64F), rotations, translations,
                                   normals);
        for (std::size_t i = 0; i < rotations.size(); ++i) {
            Eigen::Matrix3d rotation;
            Eigen::Vector3d translation;
            cv::cv2eigen(rotations[i], rotation);
            cv::cv2eigen(translations[i], translation);
            constexpr double kNoTranslation = 1e-9;  // Guard: cannot be normalised
            if (!rotation.allFinite() || !translation.allFinite() ||
                translation.norm() < kNoTranslation)
                continue;
            poses.push_back({Eigen::Quaterniond(rotation).normalized(), translation.normalized()});
        }
    } catch (const cv::Exception&) {
        poses.clear();
    }
    return poses;
}

bool RayMeeting::is_in_front(const PointPair& points) const {
    const Eigen::Vector3d ray1 = rotation_ * points.x1.homogeneous();
    const Eigen::Vector3d ray2 = points.x2.homogeneous();
    const double along1 = translation_.dot(ray1);
    const double along2 = translation_.dot(ray2);
    const double across = ray1.dot(ray2);
    // depth2 ray2 = depth1 ray1 + translation in the least-squares sense; both depths times the
    // squared length of the rays' cross product.
    const double depth1 = across * along2 - along1 * ray2.squaredNorm();
    const double depth2 = ray1.squaredNorm() * along2 - across * along1;
    return depth1 > 0 && depth2 > 0;
}

double RayMeeting::angle(const PointPair& points) const {
    const Eigen::Vector3d ray1 = rotation_ * points.x1.homogeneous();
    const Eigen::Vector3d ray2 = points.x2.homogeneous();
    return std::atan2(ray1.cross(ray2).norm(), ray1.dot(ray2));
}

PoseChoice choose_by_cheirality(std::span<const Rigid3> candidates,
                                std::span<const PointPair> points) {
    PoseChoice best{candidates.front(), 0};
    for (const Rigid3& candidate : candidates) {
        const RayMeeting meeting(candidate);
        const auto in_front = static_cast<std::size_t>(std::ranges::count_if(
            points, [&](const PointPair& p) { return meeting.is_in_front(p); }));
        if (in_front > best.in_front) best = {candidate, in_front};
    }
    return best;
}

double median_triangulation_angle_deg(const Rigid3& cam2_from_cam1,
                                      std::span<const PointPair> points) {
    if (points.empty()) return 0.0;
    const RayMeeting meeting(cam2_from_cam1);
    std::vector<double> angles;
    angles.reserve(points.size());
    for (const PointPair& p : points) angles.push_back(meeting.angle(p));
    return degrees_from_radians(upper_median(std::move(angles)));
}

}  // namespace psfm
