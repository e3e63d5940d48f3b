// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/point_grid.h"

#include <algorithm>
#include <cmath>

namespace psfm::synthetic {

PointGrid::PointGrid(const std::vector<SurfacePoint>& points, double cell) : cell_(cell) {
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3i at = cell_of(points[i].position);
        low_ = i == 0 ? at : low_.cwiseMin(at).eval();
        high_ = i == 0 ? at : high_.cwiseMax(at).eval();
        cells_[key(at)].push_back(i);
    }
}

std::vector<std::uint32_t> PointGrid::near(const Eigen::Vector3d& centre, double radius) const {
    std::vector<std::uint32_t> found;
    if (cells_.empty()) return found;
    Eigen::Vector3i first = low_;
    Eigen::Vector3i last = high_;
    if (std::isfinite(radius) && std::isfinite(cell_)) {
        const Eigen::Vector3d reach = Eigen::Vector3d::Constant(radius);
        first = low_.cwiseMax(cell_of(centre - reach));
        last = high_.cwiseMin(cell_of(centre + reach));
    }
    for (int x = first.x(); x <= last.x(); ++x) {
        for (int y = first.y(); y <= last.y(); ++y) {
            for (int z = first.z(); z <= last.z(); ++z) {
                const auto cell = cells_.find(key({x, y, z}));
                if (cell == cells_.end()) continue;
                found.insert(found.end(), cell->second.begin(), cell->second.end());
            }
        }
    }
    std::ranges::sort(found);
    return found;
}

Eigen::Vector3i PointGrid::cell_of(const Eigen::Vector3d& position) const {
    if (!std::isfinite(cell_)) return Eigen::Vector3i::Zero();
    // Clamped to what key() can hold: a million cells either way.
    constexpr double kLimit = 1 << 20;
    const Eigen::Vector3d scaled = position / cell_;
    return scaled.array().floor().max(-kLimit).min(kLimit - 1).cast<int>();
}

std::uint64_t PointGrid::key(const Eigen::Vector3i& cell) {
    constexpr int kOffset = 1 << 20;
    const auto part = [&](int i) { return static_cast<std::uint64_t>(cell[i] + kOffset); };
    return part(0) << 42U | part(1) << 21U | part(2);
}

}  // namespace psfm::synthetic
