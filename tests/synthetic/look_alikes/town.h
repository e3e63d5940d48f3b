// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace psfm::synthetic {

/// A side of a block that faces a street.
struct TownSide {
    Eigen::Vector3d foot = Eigen::Vector3d::Zero();     ///< the middle of its lower edge
    Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< unit, towards the street
};

struct TownStreet {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    Eigen::Vector3d along = Eigen::Vector3d::UnitX();  ///< unit
};

/// A square of blocks with streets between them; the middle is the origin, the ground is z = 0.
/// Immutable, thread-safe.
class Town {
  public:
    static constexpr double kBlock = 40.0;   ///< a side of a block [m]
    static constexpr double kStreet = 14.0;  ///< width of a street [m]

    /// @param blocks  along each side of the town. REQUIRES: blocks >= 2
    explicit Town(std::uint32_t blocks);

    std::uint32_t street_count() const { return 2 * (blocks_ - 1); }
    double street_length() const { return blocks_ * kPitch - kStreet; }  ///< [m]
    std::vector<TownStreet> streets() const;

    /// Sides at the town's edge face no street, and are none.
    const std::vector<TownSide>& sides() const { return sides_; }
    /// Indices into sides() of those of the nearest nine blocks: all that can be seen from within
    /// about a block's length.
    std::vector<std::size_t> sides_near(const Eigen::Vector3d& position) const;

    /// Whether a block stands between two points. Reliefs of a metre do not hide themselves.
    bool hides(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

  private:
    static constexpr double kPitch = kBlock + kStreet;
    Eigen::Vector2d middle_of(std::int64_t x, std::int64_t y) const;
    /// Of the block whose middle is nearest along one axis.
    std::int64_t nearest(double coordinate) const;
    std::size_t block_index(std::int64_t x, std::int64_t y) const;

    std::uint32_t blocks_;
    std::vector<TownSide> sides_;
    std::vector<std::vector<std::size_t>> sides_of_block_;
};

}  // namespace psfm::synthetic
