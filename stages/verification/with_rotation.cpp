// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/with_rotation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/decompositions.h"
#include "stages/algorithms/two_view/decompose_two_view.h"
#include "stages/verification/fit_two_view.h"

namespace psfm {
namespace {

/// The direction that is most nearly in the plane of each pair of rays. Reweighted, so that wrong
/// matches let go of it. Length 1; the sign is that of chance.
Eigen::Vector3d direction_for(std::span<const PointPair> points, const Eigen::Quaterniond& rotation,
                              const WithRotationOptions& options) {
    constexpr int kReweightings = 10;  // Guard: ends the reweighting
    std::vector<Eigen::Vector3d> normals;
    normals.reserve(points.size());
    for (const PointPair& p : points) {
        const Eigen::Vector3d ray1 = rotation * p.x1.homogeneous().normalized();
        normals.push_back(ray1.cross(p.x2.homogeneous().normalized()));
    }
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
    for (int round = 0; round < kReweightings; ++round) {
        Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
        for (const Eigen::Vector3d& normal : normals) {
            const double off = round == 0 ? 0.0 : normal.dot(direction) / options.loss_scale;
            scatter += normal * normal.transpose() / (1.0 + off * off);
        }
        direction = eigensystem(scatter).vectors.col(0);
    }
    return direction;
}

}  // namespace

Result<TwoViewGeometry> with_rotation(const TwoViewGeometry& geometry, const MatchedViews& views,
                                      const Eigen::Quaterniond& cam2_from_cam1_rotation,
                                      const VerifyOptions& asked,
                                      const WithRotationOptions& options) {
    const VerifyOptions verify = options_for(asked, views.camera1, views.camera2);
    MatchedViews inliers_only = views;
    inliers_only.matches = geometry.inliers;
    const Result<TwoViewProblem> made = make_two_view_problem(inliers_only, verify.max_error_px);
    if (!made.ok()) return made.error();
    const TwoViewProblem& problem = *made;
    Indices all(problem.matches.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    Rigid3 pose;
    pose.rotation = cam2_from_cam1_rotation.normalized();
    pose.translation = direction_for(problem.normalized, pose.rotation, options);
    Rigid3 opposite = pose;
    opposite.translation = -pose.translation;
    pose = choose_by_cheirality(std::vector{pose, opposite}, problem.normalized).cam2_from_cam1;
    const TwoViewModel model = fit_pose(problem, pose, all, verify);
    const double degrees =
        degrees_from_radians(model.cam2_from_cam1.rotation.angularDistance(pose.rotation));
    const auto least = std::max(static_cast<double>(verify.min_inliers),
                                options.min_kept * static_cast<double>(geometry.inliers.size()));
    if (static_cast<double>(model.inliers.size()) < least || !(degrees <= options.max_angle_deg)) {
        return Error{ErrorCode::kDegenerate, std::to_string(model.inliers.size()) + " of " +
                                                 std::to_string(geometry.inliers.size()) +
                                                 " matches agree with the rotation"};
    }
    TwoViewGeometry seen = geometry;
    seen.kind = TwoViewKind::kEssential;
    seen.matrix = model.matrix;
    seen.cam2_from_cam1 = model.cam2_from_cam1;
    seen.inliers = feature_matches(problem, model.inliers);
    seen.median_angle_deg = median_triangulation_angle_deg(
        model.cam2_from_cam1, select(problem.normalized, model.inliers));
    return seen;
}

}  // namespace psfm
