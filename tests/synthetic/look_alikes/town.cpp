// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/look_alikes/town.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace psfm::synthetic {
namespace {

/// What stands out of a facade hides nothing.
constexpr double kClearance = 1.0;  // [m]

/// Whether a segment meets the inside of a square (the slab method of ray tracing).
bool meets_square(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                  const Eigen::Vector2d& middle, double half) {
    double enter = 0.0;
    double leave = 1.0;
    for (int axis = 0; axis < 2; ++axis) {
        const double start = from[axis] - middle[axis];
        const double way = to[axis] - from[axis];
        if (std::abs(way) < 1e-9) {
            if (std::abs(start) >= half) return false;
            continue;
        }
        const double near = (-half - start) / way;
        const double far = (half - start) / way;
        enter = std::max(enter, std::min(near, far));
        leave = std::min(leave, std::max(near, far));
    }
    return enter < leave;
}

}  // namespace

Town::Town(std::uint32_t blocks) : blocks_(blocks) {
    struct Direction {
        int x, y;
    };
    constexpr std::array<Direction, 4> kDirections{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
    const auto inside = [&](std::int64_t i) { return i >= 0 && i < blocks_; };
    for (std::int64_t y = 0; y < blocks_; ++y) {
        for (std::int64_t x = 0; x < blocks_; ++x) {
            std::vector<std::size_t>& of_block = sides_of_block_.emplace_back();
            const Eigen::Vector2d middle = middle_of(x, y);
            for (const Direction& direction : kDirections) {
                if (!inside(x + direction.x) || !inside(y + direction.y)) continue;
                const Eigen::Vector3d normal(direction.x, direction.y, 0.0);
                of_block.push_back(sides_.size());
                sides_.push_back(
                    {Eigen::Vector3d(middle.x(), middle.y(), 0.0) + 0.5 * kBlock * normal, normal});
            }
        }
    }
}

std::vector<TownStreet> Town::streets() const {
    std::vector<TownStreet> result;
    for (std::uint32_t i = 0; i + 1 < blocks_; ++i) {
        const double between = kPitch * (i + 1 - 0.5 * blocks_);
        result.push_back({{between, 0.0, 0.0}, Eigen::Vector3d::UnitY()});
        result.push_back({{0.0, between, 0.0}, Eigen::Vector3d::UnitX()});
    }
    return result;
}

std::vector<std::size_t> Town::sides_near(const Eigen::Vector3d& position) const {
    std::vector<std::size_t> result;
    const std::int64_t last = blocks_ - 1;
    const std::int64_t x = nearest(position.x());
    const std::int64_t y = nearest(position.y());
    for (auto j = std::max<std::int64_t>(y - 1, 0); j <= std::min(y + 1, last); ++j) {
        for (auto i = std::max<std::int64_t>(x - 1, 0); i <= std::min(x + 1, last); ++i) {
            const std::vector<std::size_t>& sides = sides_of_block_[block_index(i, j)];
            result.insert(result.end(), sides.begin(), sides.end());
        }
    }
    return result;
}

bool Town::hides(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
    const Eigen::Vector2d start = from.head<2>();
    const Eigen::Vector2d end = to.head<2>();
    const Eigen::Vector2d low = start.cwiseMin(end);
    const Eigen::Vector2d high = start.cwiseMax(end);
    for (std::int64_t y = nearest(low.y()); y <= nearest(high.y()); ++y) {
        for (std::int64_t x = nearest(low.x()); x <= nearest(high.x()); ++x) {
            if (meets_square(start, end, middle_of(x, y), 0.5 * kBlock - kClearance)) return true;
        }
    }
    return false;
}

Eigen::Vector2d Town::middle_of(std::int64_t x, std::int64_t y) const {
    const double first = 0.5 * (1.0 - blocks_);
    return kPitch * Eigen::Vector2d(first + static_cast<double>(x), first + static_cast<double>(y));
}

std::int64_t Town::nearest(double coordinate) const {
    const std::int64_t last = blocks_ - 1;
    return std::clamp<std::int64_t>(std::llround(coordinate / kPitch + 0.5 * (blocks_ - 1.0)), 0,
                                    last);
}

std::size_t Town::block_index(std::int64_t x, std::int64_t y) const {
    return static_cast<std::size_t>(y * blocks_ + x);
}

}  // namespace psfm::synthetic
