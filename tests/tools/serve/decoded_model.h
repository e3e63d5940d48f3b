// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>

#include "graph/sim3.h"

namespace psfm::testing {

/// What a watcher makes of changes, written from docs/serve.md alone.
class DecodedModel {
  public:
    struct Point {
        Eigen::Vector3d position;
        std::uint32_t born = 0;
    };
    struct Cluster {
        Sim3 place;
        std::uint32_t part = 0;
        std::map<std::uint32_t, Point> points;  // by slot
        std::map<std::uint32_t, Eigen::Vector3d> cameras;
    };

    /// Throws std::runtime_error at what is no change.
    void apply(std::string_view change);

    std::uint32_t number = 0;
    std::uint64_t version = 0;
    std::map<std::uint32_t, Cluster> clusters;
    std::size_t points_put = 0, points_moved = 0, parts = 0;

    std::size_t point_count() const {
        std::size_t count = 0;
        for (const auto& [id, cluster] : clusters) count += cluster.points.size();
        return count;
    }
    std::optional<Eigen::Vector3d> world(std::uint32_t cluster, std::uint32_t slot) const {
        const auto found = clusters.find(cluster);
        if (found == clusters.end() || !found->second.points.contains(slot)) return std::nullopt;
        return found->second.place * found->second.points.at(slot).position;
    }
};

}  // namespace psfm::testing
