// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/average_positions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "stages/algorithms/averaging/chordal_positions.h"
#include "stages/algorithms/averaging/least_unsquared_positions.h"
#include "stages/algorithms/averaging/length_certainty.h"
#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/median.h"

namespace psfm {
namespace {

/// Edges among some nodes, with the nodes numbered as in `nodes` and a mean weight of 1.
std::vector<RelativeDirection> edges_among(std::span<const RelativeDirection> edges,
                                           const std::vector<std::uint32_t>& nodes) {
    std::vector<RelativeDirection> among;
    double sum = 0.0;
    for (const RelativeDirection& edge : edges) {
        const auto i = std::ranges::lower_bound(nodes, edge.i);
        const auto j = std::ranges::lower_bound(nodes, edge.j);
        if (i == nodes.end() || *i != edge.i || j == nodes.end() || *j != edge.j) continue;
        among.push_back({static_cast<std::uint32_t>(i - nodes.begin()),
                         static_cast<std::uint32_t>(j - nodes.begin()), edge.direction,
                         edge.weight});
        sum += edge.weight;
    }
    const double factor = static_cast<double>(among.size()) / sum;
    for (RelativeDirection& edge : among) edge.weight *= factor;
    return among;
}

/// Moves the mean to the origin and makes the median length 1.
void fix_gauge(const std::vector<RelativeDirection>& edges, Columns3& positions) {
    positions.colwise() -= Eigen::Vector3d(positions.rowwise().mean());
    std::vector<double> lengths;
    lengths.reserve(edges.size());
    for (const RelativeDirection& edge : edges) {
        lengths.push_back((positions.col(edge.j) - positions.col(edge.i)).norm());
    }
    const double middle = upper_median(std::move(lengths));
    if (middle > 0.0) positions /= middle;
}

Columns3 columns_of(const Columns3& positions, const std::vector<std::uint32_t>& nodes) {
    Columns3 chosen(3, static_cast<Eigen::Index>(nodes.size()));
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        chosen.col(static_cast<Eigen::Index>(k)) = positions.col(nodes[k]);
    }
    return chosen;
}

/// Nodes of a component that have a place, and where.
struct Placement {
    std::vector<std::uint32_t> nodes;
    Columns3 positions;
    double noise = 0.0;  ///< [rad]
};

Result<Placement> place(std::span<const RelativeDirection> edges,
                        const std::vector<std::uint32_t>& component,
                        const PositionAveragingOptions& options) {
    const std::vector<RelativeDirection> inside = edges_among(edges, component);
    auto start =
        least_unsquared_positions(inside, static_cast<std::uint32_t>(component.size()), options);
    if (!start.ok()) return start.error();
    auto refined = refine_positions(inside, *std::move(start), options);
    if (!refined.ok()) return refined.error();
    auto certain = nodes_of_certain_length(inside, *refined, options);
    if (!certain.ok()) return certain.error();
    Placement placement;
    placement.noise = direction_noise(inside, *refined);
    placement.positions = columns_of(*refined, *certain);
    for (const std::uint32_t node : *certain) placement.nodes.push_back(component[node]);
    return placement;
}

}  // namespace

Result<void> validate(const PositionAveragingOptions& options) {
    if (options.max_start_iterations == 0 || options.max_refinement_iterations < 1 ||
        !(options.start_convergence > 0.0) || !(options.loss_scale_deg > 0.0) ||
        !(options.max_length_sigma > 0.0) || !(options.min_noise_deg > 0.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "position averaging: all options must be positive"};
    }
    return {};
}

Result<PositionAveraging> average_positions(std::span<const RelativeDirection> edges,
                                            std::uint32_t node_count,
                                            const PositionAveragingOptions& options) {
    if (auto valid = validate(options); !valid.ok()) return valid.error();
    if (auto valid = check_directions(edges, node_count); !valid.ok()) return valid.error();
    const Error degenerate{ErrorCode::kDegenerate,
                           "the directions determine the positions of fewer than three nodes: "
                           "they are too few, or the nodes lie on a line"};
    if (edges.empty()) return degenerate;
    auto placement = place(edges, largest_component(edges, node_count), options);
    if (!placement.ok()) return placement.error();
    if (placement->nodes.size() < 3) return degenerate;

    fix_gauge(edges_among(edges, placement->nodes), placement->positions);
    PositionAveraging result;
    result.placed = static_cast<std::uint32_t>(placement->nodes.size());
    result.noise_deg = placement->noise * kDegreesPerRadian;
    result.position.resize(node_count);
    for (std::size_t k = 0; k < placement->nodes.size(); ++k) {
        result.position[placement->nodes[k]] =
            placement->positions.col(static_cast<Eigen::Index>(k));
    }
    result.residual_deg.resize(edges.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto& i = result.position[edges[e].i];
        const auto& j = result.position[edges[e].j];
        if (!i || !j) continue;
        const Eigen::Vector3d difference = *j - *i;
        result.residual_deg[e] = std::atan2(difference.cross(edges[e].direction).norm(),
                                            difference.dot(edges[e].direction)) *
                                 kDegreesPerRadian;
    }
    return result;
}

}  // namespace psfm
