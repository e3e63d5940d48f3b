// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/evaluation/pose_auc.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/algorithms/math/angles.h"

namespace psfm {
namespace {

/// Angle between two vectors [rad], exact for small angles too.
double angle_between_vectors(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Whether a baseline is nothing but rounding of the centres it was computed from.
bool is_zero_baseline(const Eigen::Vector3d& centre1, const Eigen::Vector3d& centre2) {
    constexpr double kRounding = 1e-12;  // Guard: of centres that are one
    return (centre1 - centre2).norm() <= kRounding * (centre1.norm() + centre2.norm());
}

double pair_error_deg(const Rigid3& reference1, const Rigid3& reference2, const Rigid3& model1,
                      const Rigid3& model2) {
    const Rigid3 reference = reference2 * inverse(reference1);  // cam2_from_cam1
    const Rigid3 model = model2 * inverse(model1);
    const double rotation = angle_between(reference.rotation, model.rotation);
    if (is_zero_baseline(reference1.target_origin_in_source(),
                         reference2.target_origin_in_source())) {
        return rotation * kDegreesPerRadian;
    }
    if (is_zero_baseline(model1.target_origin_in_source(), model2.target_origin_in_source())) {
        return std::numeric_limits<double>::infinity();
    }
    return std::max(rotation, angle_between_vectors(reference.translation, model.translation)) *
           kDegreesPerRadian;
}

}  // namespace

std::vector<double> relative_pose_auc(std::span<const NamedPose> reference,
                                      std::span<const NamedPose> model,
                                      std::span<const double> limits_deg) {
    const std::vector<NameMatch> matches = match_by_name(reference, model);
    std::vector<double> sums(limits_deg.size(), 0.0);
    for (std::size_t i = 0; i < matches.size(); ++i) {
        for (std::size_t j = i + 1; j < matches.size(); ++j) {
            const double error = pair_error_deg(reference[matches[i].reference].cam_from_world,
                                                reference[matches[j].reference].cam_from_world,
                                                model[matches[i].model].cam_from_world,
                                                model[matches[j].model].cam_from_world);
            for (std::size_t k = 0; k < limits_deg.size(); ++k) {
                sums[k] += std::max(0.0, 1.0 - error / limits_deg[k]);
            }
        }
    }
    const auto count = static_cast<double>(reference.size());
    const double pairs = 0.5 * count * (count - 1.0);
    for (double& sum : sums) sum = pairs > 0.0 ? sum / pairs : 0.0;
    return sums;
}

}  // namespace psfm
