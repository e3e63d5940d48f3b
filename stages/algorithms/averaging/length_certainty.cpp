// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/length_certainty.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "graph/sorted_unique.h"
#include "stages/algorithms/averaging/chordal_positions.h"
#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/median.h"
#include "stages/algorithms/math/random_numbers.h"
#include "stages/algorithms/math/union_find.h"

namespace psfm {
namespace {

/// Mathematics: with 16, a length that is known to 1 relative to another passes for known to 0.3
/// with a probability below 1e-6 (chi-squared with 16 degrees of freedom).
constexpr Eigen::Index kDraws = 16;
constexpr std::uint64_t kSeed = 0x1d5f;  // Guard: any; the same draws on every run
/// Guard: standard deviation of the prior, in median lengths of the edges: nothing is known
/// beforehand.
constexpr double kPriorSigma = 10.0;
constexpr double kLeastChord = 1e-12;  // Guard: nothing is divided by less
/// Guard: lengths, in median lengths, below which nothing is divided by them.
constexpr double kLeastLengthPart = 1e-6;

Eigen::Vector3d normal3(RandomNumbers& random) {
    Eigen::Vector3d vector;
    for (double& coordinate : vector) coordinate = random.normal();
    return vector;
}

/// What an edge says at the present positions: information block^T block, unit direction / length.
struct EdgeInformation {
    Eigen::Matrix3d root;  ///< symmetric
    Eigen::Vector3d along_over_length;
};

std::vector<EdgeInformation> information_of(const std::vector<RelativeDirection>& edges,
                                            const Columns3& positions, double sigma,
                                            double loss_scale, double min_length) {
    std::vector<EdgeInformation> information;
    information.reserve(edges.size());
    for (const RelativeDirection& edge : edges) {
        const Eigen::Vector3d difference = positions.col(edge.j) - positions.col(edge.i);
        const double length = std::max(difference.norm(), min_length);
        const Eigen::Vector3d along = difference / length;
        const double trust =
            edge.weight * std::min(1.0, loss_scale / std::max(chord(edge, positions), kLeastChord));
        information.push_back({std::sqrt(trust) / (sigma * length) *
                                   (Eigen::Matrix3d::Identity() - along * along.transpose()),
                               along / length});
    }
    return information;
}

}  // namespace

double direction_noise(const std::vector<RelativeDirection>& edges, const Columns3& positions) {
    std::vector<double> chords;
    chords.reserve(edges.size());
    for (const RelativeDirection& edge : edges) chords.push_back(chord(edge, positions));
    // The length of a normal vector in the plane has its median at sqrt(2 ln 2) sigma.
    return upper_median(std::move(chords)) / std::sqrt(2.0 * std::numbers::ln2);
}

Result<std::vector<std::uint32_t>> nodes_of_certain_length(
    const std::vector<RelativeDirection>& edges, const Columns3& positions,
    const PositionAveragingOptions& options) {
    const double sigma =
        std::max(direction_noise(edges, positions), options.min_noise_deg * kRadiansPerDegree);
    std::vector<double> lengths;
    lengths.reserve(edges.size());
    for (const RelativeDirection& edge : edges) {
        lengths.push_back((positions.col(edge.j) - positions.col(edge.i)).norm());
    }
    const double median = upper_median(std::move(lengths));
    const std::vector<EdgeInformation> information =
        information_of(edges, positions, sigma, options.loss_scale_deg * kRadiansPerDegree,
                       kLeastLengthPart * median);

    const auto node_count = static_cast<std::uint32_t>(positions.cols());
    const double prior = 1.0 / (kPriorSigma * median);
    PositionSystem system(edges, node_count);
    std::vector<Eigen::Matrix3d> blocks;
    blocks.reserve(information.size());
    for (const EdgeInformation& edge : information) blocks.push_back(edge.root * edge.root);
    if (!system.factor(blocks, Eigen::VectorXd::Constant(node_count, prior * prior))) {
        return Error{ErrorCode::kInternal,
                     "position averaging: CHOLMOD cannot factor the information matrix"};
    }
    // Perturb and solve: the right-hand side has the matrix as covariance, the solution its
    // inverse.
    RandomNumbers random(kSeed);
    Eigen::MatrixXd change(kDraws, static_cast<Eigen::Index>(edges.size()));
    for (Eigen::Index draw = 0; draw < kDraws; ++draw) {
        Columns3 right_side(3, node_count);
        for (std::uint32_t node = 0; node < node_count; ++node) {
            right_side.col(node) = prior * normal3(random);
        }
        for (std::size_t e = 0; e < edges.size(); ++e) {
            const Eigen::Vector3d pull = information[e].root * normal3(random);
            right_side.col(edges[e].j) += pull;
            right_side.col(edges[e].i) -= pull;
        }
        const Columns3 shift = system.solve(right_side);
        for (std::size_t e = 0; e < edges.size(); ++e) {
            change(draw, static_cast<Eigen::Index>(e)) =
                information[e].along_over_length.dot(shift.col(edges[e].j) - shift.col(edges[e].i));
        }
    }

    std::vector<std::vector<std::uint32_t>> at(node_count);
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
        at[edges[e].i].push_back(e);
        at[edges[e].j].push_back(e);
    }
    const double max_square =
        options.max_length_sigma * options.max_length_sigma * static_cast<double>(kDraws);
    UnionFind sets(edges.size());  // edges that meet and change by the same part are joined
    for (std::vector<std::uint32_t> open : at) {
        while (open.size() > 1) {
            const std::uint32_t pivot = open.front();
            std::erase_if(open, [&](std::uint32_t e) {
                const bool same = (change.col(e) - change.col(pivot)).squaredNorm() <= max_square;
                if (same) sets.join(pivot, e);
                return same;
            });
        }
    }
    std::vector<std::vector<std::uint32_t>> nodes(edges.size());  // by root, with repetitions
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
        nodes[sets.root_of(e)].insert(nodes[sets.root_of(e)].end(), {edges[e].i, edges[e].j});
    }
    std::vector<std::uint32_t> best;
    for (std::vector<std::uint32_t>& set : nodes) {
        sort_unique(set);
        if (set.size() > std::max<std::size_t>(best.size(), 2)) best = std::move(set);
    }
    return best;
}

}  // namespace psfm
