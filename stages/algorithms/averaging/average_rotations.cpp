// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/average_rotations.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "graph/rigid3.h"
#include "graph/sorted_unique.h"
#include "stages/algorithms/averaging/l1_rotation_solver.h"
#include "stages/algorithms/averaging/refine_rotations.h"
#include "stages/algorithms/averaging/rotation_problem.h"
#include "stages/algorithms/averaging/start_rotations.h"
#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/maximum_spanning_tree.h"

namespace psfm {
namespace {

Error invalid(const std::string& what) {
    return {ErrorCode::kInvalidArgument, "rotation averaging: " + what};
}

Result<void> check_edges(std::span<const RelativeRotation> edges, std::uint32_t node_count) {
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const RelativeRotation& edge = edges[e];
        const std::string name = "edge " + std::to_string(e);
        if (edge.i == edge.j) return invalid(name + " joins a node to itself");
        if (std::max(edge.i, edge.j) >= node_count) return invalid(name + " has an unknown node");
        if (!(edge.weight > 0.0) || !std::isfinite(edge.weight)) {
            return invalid(name + " has a weight that is not positive");
        }
        const double norm = edge.j_from_i.norm();
        if (!(norm > 0.0) || !std::isfinite(norm)) return invalid(name + " has no rotation");
    }
    return {};
}

std::vector<WeightedEdge> weights_of(std::span<const RelativeRotation> edges) {
    std::vector<WeightedEdge> weighted;
    weighted.reserve(edges.size());
    for (const RelativeRotation& edge : edges) weighted.push_back({edge.i, edge.j, edge.weight});
    return weighted;
}

/// The forest and each node's strongest edges; all edges when `count` is 0. Ascending.
std::vector<std::uint32_t> pulling_edges(std::span<const WeightedEdge> edges,
                                         std::uint32_t node_count, std::uint32_t count) {
    std::vector<std::uint32_t> chosen;
    if (count == 0) {
        chosen.resize(edges.size());
        std::iota(chosen.begin(), chosen.end(), 0U);
        return chosen;
    }
    chosen = maximum_spanning_forest(edges, node_count);
    std::vector<std::uint32_t> taken(node_count, 0);
    for (const std::uint32_t e : heaviest_first(edges)) {
        const bool first = taken[edges[e].i]++ < count;
        const bool second = taken[edges[e].j]++ < count;
        if (first || second) chosen.push_back(e);
    }
    sort_unique(chosen);
    return chosen;
}

std::vector<double> residuals_deg(std::span<const RelativeRotation> edges,
                                  const std::vector<Eigen::Quaterniond>& node_from_reference) {
    std::vector<double> residuals;
    residuals.reserve(edges.size());
    for (const RelativeRotation& edge : edges) {
        const Eigen::Quaterniond j_from_i =
            node_from_reference[edge.j] * node_from_reference[edge.i].conjugate();
        residuals.push_back(
            degrees_from_radians(angle_between(edge.j_from_i.normalized(), j_from_i)));
    }
    return residuals;
}

void make_mean_weight_one(RotationProblem& problem) {
    double sum = 0.0;
    for (const RotationProblem::Edge& edge : problem.edges) sum += edge.weight;
    const double factor = static_cast<double>(problem.edges.size()) / sum;
    for (RotationProblem::Edge& edge : problem.edges) edge.weight *= factor;
}

}  // namespace

Result<void> validate(const RotationAveragingOptions& options) {
    if (!(options.weight_power >= 0.0 && options.weight_power <= 8.0)) {
        return invalid("weight_power must be between 0 and 8; 1 is the paper's");
    }
    if (!(options.convergence_deg > 0.0)) return invalid("convergence_deg must be positive");
    if (!(options.consensus_deg >= 0.0)) return invalid("consensus_deg must not be negative");
    if (!(options.turn_again_factor >= 0.0))
        return invalid("turn_again_factor must not be negative");
    if (!(options.loss_scale_deg > 0.0)) return invalid("loss_scale_deg must be positive");
    if (options.max_iterations > 0 && options.max_solver_iterations == 0) {
        return invalid("max_solver_iterations must be at least 1");
    }
    return {};
}

Result<RotationAveraging> average_rotations(std::span<const RelativeRotation> edges,
                                            std::uint32_t node_count,
                                            const RotationAveragingOptions& options) {
    if (auto valid = validate(options); !valid.ok()) return valid.error();
    if (auto valid = check_edges(edges, node_count); !valid.ok()) return valid.error();

    const std::vector<WeightedEdge> weighted = weights_of(edges);
    StartRotations start =
        options.consensus_deg > 0.0
            ? rotations_by_consensus(edges, heaviest_first(weighted), node_count, options)
            : rotations_of_forest(edges, maximum_spanning_forest(weighted, node_count), node_count);

    RotationAveraging result;
    result.node_from_reference = std::move(start.node_from_reference);
    result.component = std::move(start.component);
    result.component_count = start.component_count;
    result.start_residual_deg = residuals_deg(edges, result.node_from_reference);

    // Components as problems of their own; nodes ascending, so that node 0 is the reference.
    std::vector<RotationProblem> problems(result.component_count);
    std::vector<std::uint32_t> local(node_count);
    for (std::uint32_t node = 0; node < node_count; ++node) {
        RotationProblem& problem = problems[result.component[node]];
        local[node] = static_cast<std::uint32_t>(problem.node_from_reference.size());
        problem.node_from_reference.push_back(result.node_from_reference[node]);
    }
    for (const std::uint32_t e :
         pulling_edges(weighted, node_count, options.strongest_edges_per_node)) {
        const RelativeRotation& edge = edges[e];
        problems[result.component[edge.i]].edges.push_back(
            {local[edge.i], local[edge.j], edge.j_from_i.normalized(),
             std::pow(edge.weight, options.weight_power)});
    }
    for (RotationProblem& problem : problems) {
        if (problem.edges.empty()) continue;
        make_mean_weight_one(problem);
        auto coarse = minimize_l1(problem, options);
        if (!coarse.ok()) return coarse.error();
        auto fine = refine_rotations(problem, options);
        if (!fine.ok()) return fine.error();
        result.iterations = std::max(result.iterations, *coarse + *fine);
    }
    for (std::uint32_t node = 0; node < node_count; ++node) {
        result.node_from_reference[node] =
            problems[result.component[node]].node_from_reference[local[node]];
    }
    result.residual_deg = residuals_deg(edges, result.node_from_reference);
    return result;
}

std::vector<std::uint32_t> edges_within(const RotationAveraging& averaging, double max_deg) {
    std::vector<std::uint32_t> within;
    for (std::uint32_t e = 0; e < averaging.residual_deg.size(); ++e) {
        if (averaging.residual_deg[e] <= max_deg) within.push_back(e);
    }
    return within;
}

}  // namespace psfm
