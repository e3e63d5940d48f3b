// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "tests/synthetic/scene.h"

namespace psfm::synthetic {

/// Points sorted into cubic cells, so that what is near a camera is found without looking at every
/// point. Immutable after construction, thread-safe.
class PointGrid {
  public:
    /// @param cell edge length [m]; infinity puts everything into one cell
    PointGrid(const std::vector<SurfacePoint>& points, double cell);

    /// Indices of at least all points within `radius` of `centre`, ascending.
    std::vector<std::uint32_t> near(const Eigen::Vector3d& centre, double radius) const;

  private:
    Eigen::Vector3i cell_of(const Eigen::Vector3d& position) const;
    static std::uint64_t key(const Eigen::Vector3i& cell);

    double cell_;
    Eigen::Vector3i low_ = Eigen::Vector3i::Zero(), high_ = Eigen::Vector3i::Zero();
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace psfm::synthetic
