// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/least_unsquared_positions.h"

#include <algorithm>
#include <cmath>

namespace psfm {
namespace {

/// Guard: deviations below this are squared after all [smallest length allowed]: keeps the cost
/// smooth and the weights finite.
constexpr double kSmoothing = 1e-3;
/// Guard: weight of every node's coordinates, in parts of the mean over the nodes of what holds
/// them: where the directions leave a node free (on a line, say), it stays where it is.
constexpr double kDamping = 1e-8;
/// Guard: parts of a step below which none is tried: ends the search.
constexpr double kLeastFraction = 1e-3;

/// An edge at given positions.
struct Deviation {
    Eigen::Vector3d vector;  ///< from the nearest allowed difference
    bool shortest;           ///< the length is at its bound
};

Deviation deviation_of(const RelativeDirection& edge, const Columns3& positions) {
    const Eigen::Vector3d difference = positions.col(edge.j) - positions.col(edge.i);
    const double length = edge.direction.dot(difference);
    return {difference - std::max(length, 1.0) * edge.direction, length <= 1.0};
}

double smoothed(double deviation) {
    return deviation > kSmoothing ? deviation
                                  : 0.5 * (deviation * deviation / kSmoothing + kSmoothing);
}

double cost_of(const std::vector<RelativeDirection>& edges, const Columns3& positions) {
    double cost = 0.0;
    for (const RelativeDirection& edge : edges) {
        cost += edge.weight * smoothed(deviation_of(edge, positions).vector.norm());
    }
    return cost;
}

struct Linearisation {
    std::vector<Eigen::Matrix3d> blocks;
    Eigen::VectorXd anchors;
    Columns3 descent;  ///< minus the gradient
};

Linearisation linearise(const std::vector<RelativeDirection>& edges, const Columns3& positions) {
    Linearisation system;
    system.blocks.reserve(edges.size());
    system.descent = Columns3::Zero(3, positions.cols());
    double held = 0.0;
    for (const RelativeDirection& edge : edges) {
        const Deviation deviation = deviation_of(edge, positions);
        const double weight = edge.weight / std::max(deviation.vector.norm(), kSmoothing);
        Eigen::Matrix3d block = Eigen::Matrix3d::Identity();
        if (!deviation.shortest) block -= edge.direction * edge.direction.transpose();
        system.blocks.push_back(weight * block);
        system.descent.col(edge.j) -= weight * deviation.vector;
        system.descent.col(edge.i) += weight * deviation.vector;
        held += weight;
    }
    held *= 2.0 / static_cast<double>(positions.cols());
    system.anchors = Eigen::VectorXd::Constant(positions.cols(), kDamping * held);
    // The sum does not change with a common shift, so this one anchors all, whatever its weight.
    system.anchors[0] += held;
    return system;
}

}  // namespace

Result<Columns3> least_unsquared_positions(const std::vector<RelativeDirection>& edges,
                                           std::uint32_t node_count,
                                           const PositionAveragingOptions& options) {
    PositionSystem solver(edges, node_count);
    Columns3 positions = Columns3::Zero(3, node_count);
    double cost = cost_of(edges, positions);
    for (std::uint32_t iteration = 0; iteration < options.max_start_iterations; ++iteration) {
        const Linearisation system = linearise(edges, positions);
        if (!solver.factor(system.blocks, system.anchors)) {
            return Error{ErrorCode::kInternal,
                         "position averaging: CHOLMOD cannot factor the normal matrix"};
        }
        const Columns3 step = solver.solve(system.descent);
        const double before = cost;
        for (double fraction = 1.0; fraction > kLeastFraction && cost >= before; fraction *= 0.5) {
            const Columns3 trial = positions + fraction * step;
            const double trial_cost = cost_of(edges, trial);
            if (!(trial_cost < before)) continue;
            positions = trial;
            cost = trial_cost;
        }
        if (!(cost < (1.0 - options.start_convergence) * before)) break;
    }
    positions.colwise() -= Eigen::Vector3d(positions.col(0));
    return positions;
}

}  // namespace psfm
