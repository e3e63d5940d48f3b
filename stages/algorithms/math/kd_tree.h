// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace psfm {

/// Nearest neighbours among fixed points in space: exact, for camera centres, of which there are
/// tens to thousands. FLANN's KDTreeSingleIndex, the one of its indices that uses no random
/// numbers. Thread-safe for reading; copies share the tree.
class KdTree {
  public:
    static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

    KdTree() = default;
    explicit KdTree(std::vector<Eigen::Vector3d> points);

    std::size_t size() const { return points().size(); }
    const std::vector<Eigen::Vector3d>& points() const;

    /// Distance from `query` to the nearest point but `excluded`; infinity without any.
    double nearest_distance(const Eigen::Vector3d& query, std::size_t excluded = kNone) const;
    /// Whether a point but `excluded` is nearer than `distance`: far from all of them this is told
    /// at once.
    bool has_nearer(const Eigen::Vector3d& query, double distance,
                    std::size_t excluded = kNone) const;
    /// Indices of the points that are nearer than `distance`, ascending.
    std::vector<std::uint32_t> nearer_than(const Eigen::Vector3d& query, double distance) const;

  private:
    struct Tree;
    std::shared_ptr<const Tree> tree_;  // null: no points
};

}  // namespace psfm
