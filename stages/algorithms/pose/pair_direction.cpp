// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/pose/pair_direction.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "stages/algorithms/math/decompositions.h"
#include "stages/algorithms/math/median.h"

namespace psfm {
namespace {

/// Guard: deviations count as noise below this [rad]: a tenth of a pixel at f = 1000 px.
constexpr double kMinScale = 1e-4;
constexpr int kIterations = 20;  // Guard: ends the loop
/// Guard: 1 - cosine of a change that is none: ends the loop.
constexpr double kNoChange = 1e-12;

double median_deviation(const std::vector<Eigen::Vector3d>& normals,
                        const Eigen::Vector3d& direction) {
    std::vector<double> deviations;
    deviations.reserve(normals.size());
    for (const Eigen::Vector3d& normal : normals) {
        deviations.push_back(std::abs(direction.dot(normal)));
    }
    return upper_median(std::move(deviations));
}

/// One step of reweighted least squares; the sign is arbitrary.
Eigen::Vector3d refit(const std::vector<Eigen::Vector3d>& normals,
                      const Eigen::Vector3d& direction) {
    const double scale = std::max(2.0 * median_deviation(normals, direction), kMinScale);
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& normal : normals) {
        const double ratio = direction.dot(normal) / scale;
        const double root = 1.0 / (1.0 + ratio * ratio);
        scatter.noalias() += root * root * normal * normal.transpose();
    }
    return eigensystem(scatter).vectors.col(0);
}

/// Points in front of both cameras less those behind one of them.
int votes_for(std::span<const Eigen::Vector3d> rays1, std::span<const Eigen::Vector3d> rays2,
              const std::vector<Eigen::Vector3d>& normals, const Eigen::Vector3d& direction) {
    int votes = 0;
    for (std::size_t k = 0; k < normals.size(); ++k) {
        // depth1 * ray1 - depth2 * ray2 = direction, both depths up to a positive factor.
        const double depth1 = direction.cross(rays2[k]).dot(normals[k]);
        const double depth2 = direction.cross(rays1[k]).dot(normals[k]);
        if (depth1 > 0.0 && depth2 > 0.0) ++votes;
        if (depth1 < 0.0 && depth2 < 0.0) --votes;
    }
    return votes;
}

}  // namespace

Eigen::Vector3d direction_between(std::span<const Eigen::Vector3d> rays1,
                                  std::span<const Eigen::Vector3d> rays2,
                                  const Eigen::Vector3d& start) {
    std::vector<Eigen::Vector3d> normals;
    normals.reserve(rays1.size());
    for (std::size_t k = 0; k < rays1.size(); ++k) normals.push_back(rays1[k].cross(rays2[k]));
    Eigen::Vector3d direction = start;
    for (int iteration = 0; iteration < kIterations; ++iteration) {
        const Eigen::Vector3d before = direction;
        direction = refit(normals, before);
        if (1.0 - std::abs(direction.dot(before)) < kNoChange) break;
    }
    if (votes_for(rays1, rays2, normals, direction) < 0) direction *= -1.0;
    return direction;
}

}  // namespace psfm
