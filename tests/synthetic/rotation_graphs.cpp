// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/rotation_graphs.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "graph/rigid3.h"
#include "stages/algorithms/math/angles.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm::synthetic {
namespace {

/// Relative rotation that absolute ones imply.
Eigen::Quaterniond relative(const std::vector<Eigen::Quaterniond>& cam_from_world, ImagePair pair) {
    return (cam_from_world[index_of(pair.second)] *
            cam_from_world[index_of(pair.first)].conjugate())
        .normalized();
}

ImagePair pair_of(std::uint32_t a, std::uint32_t b) {
    return ImagePair::of(static_cast<ImageId>(a), static_cast<ImageId>(b));
}

/// The pairs of a random spanning tree: every node is tied to one that came before it in a random
/// order.
std::set<ImagePair> random_tree(std::uint32_t nodes, Rng& rng) {
    std::vector<std::uint32_t> order(nodes);
    for (std::uint32_t i = 0; i < nodes; ++i) order[i] = i;
    rng.shuffle(order);
    std::set<ImagePair> tree;
    for (std::size_t i = 1; i < nodes; ++i) tree.insert(pair_of(order[i], order[rng.below(i)]));
    return tree;
}

/// Camera at an angle on a ring about the z axis that looks inward, z up.
Eigen::Quaterniond ring_rotation(double angle_deg) {
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(radians_from_degrees(angle_deg), Eigen::Vector3d::UnitZ()));
    Eigen::Matrix3d facing_minus_x;  // rows: right, down, forward of the camera at angle 0
    facing_minus_x << 0, 1, 0, 0, 0, -1, -1, 0, 0;
    return (Eigen::Quaterniond(facing_minus_x) * turn.conjugate()).normalized();
}

/// In [-period / 2, period / 2].
double wrapped(double angle, double period) {
    return std::remainder(angle, period);
}

}  // namespace

RotationGraph make_random_rotations(const RandomRotationOptions& options, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 30));
    RotationGraph graph;
    for (std::uint32_t i = 0; i < options.nodes; ++i)
        graph.cam_from_world.push_back(rng.rotation());
    const std::set<ImagePair> tree = random_tree(options.nodes, rng);
    for (std::uint32_t a = 0; a < options.nodes; ++a) {
        for (std::uint32_t b = a + 1; b < options.nodes; ++b) {
            const ImagePair pair = pair_of(a, b);
            const bool in_tree = tree.contains(pair);
            if (!in_tree && rng.uniform() >= options.density) continue;
            RotationEdge edge;
            edge.pair = pair;
            edge.weight = std::round(rng.uniform(options.min_weight, options.max_weight));
            const Eigen::Quaterniond truth = relative(graph.cam_from_world, pair);
            if (!in_tree && rng.uniform() < options.outlier_fraction) {
                edge.truth = RotationEdgeTruth::kRandom;
                do {
                    edge.cam2_from_cam1 = rng.rotation();
                } while (angle_between(edge.cam2_from_cam1, truth) < radians_from_degrees(20.0));
            } else {
                edge.cam2_from_cam1 =
                    rng.small_rotation(radians_from_degrees(options.noise_sigma_deg)) * truth;
            }
            graph.edges.push_back(edge);
        }
    }
    return graph;
}

FoldedRing make_folded_ring(const FoldedRingOptions& options, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 31));
    FoldedRing ring;
    const double step_deg = 360.0 / options.nodes;
    const double side_deg = 360.0 / options.folds;
    for (std::uint32_t i = 0; i < options.nodes; ++i) {
        const double angle_deg = step_deg * i;
        ring.graph.cam_from_world.push_back(ring_rotation(angle_deg));
        ring.folded_cam_from_world.push_back(ring_rotation(std::fmod(angle_deg, side_deg)));
    }
    for (std::uint32_t a = 0; a < options.nodes; ++a) {
        for (std::uint32_t b = a + 1; b < options.nodes; ++b) {
            const double apart_deg = wrapped(step_deg * (b - a), 360.0);
            const double folded_deg = wrapped(apart_deg, side_deg);
            const bool right = std::abs(apart_deg) <= options.reach_deg;
            if (!right && std::abs(folded_deg) > options.look_alike_reach_deg) continue;
            const double seen_deg = right ? apart_deg : folded_deg;
            RotationEdge edge;
            edge.pair = pair_of(a, b);
            edge.truth = right ? RotationEdgeTruth::kRight : RotationEdgeTruth::kConsistent;
            const double peak = options.peak_weight * (right ? 1.0 : options.look_alike_ratio);
            edge.weight = std::round(peak * std::exp(-std::abs(seen_deg) / options.decay_deg));
            const double angle_deg = step_deg * a;
            const Eigen::Quaterniond exact =
                ring_rotation(angle_deg + seen_deg) * ring_rotation(angle_deg).conjugate();
            edge.cam2_from_cam1 =
                (rng.small_rotation(radians_from_degrees(options.noise_sigma_deg)) * exact)
                    .normalized();
            if (edge.weight >= std::max(options.min_weight, 1.0)) ring.graph.edges.push_back(edge);
        }
    }
    return ring;
}

double edge_error_deg(const RotationEdge& edge,
                      const std::vector<Eigen::Quaterniond>& cam_from_world) {
    return degrees_from_radians(
        angle_between(edge.cam2_from_cam1, relative(cam_from_world, edge.pair)));
}

double max_rotation_error_deg(const std::vector<Eigen::Quaterniond>& estimated,
                              const std::vector<Eigen::Quaterniond>& truth) {
    // estimated[i] = truth[i] * world_from_gauge, for one rotation of the world.
    std::vector<Eigen::Quaterniond> world_from_gauge;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        world_from_gauge.push_back(truth[i].conjugate() * estimated[i]);
    }
    const Eigen::Quaterniond mean = mean_rotation(world_from_gauge);
    double largest = 0.0;
    for (const Eigen::Quaterniond& rotation : world_from_gauge) {
        largest = std::max(largest, degrees_from_radians(angle_between(rotation, mean)));
    }
    return largest;
}

ViewGraph make_view_graph(const RotationGraph& graph) {
    ViewGraph result;
    for (std::size_t i = 0; i < graph.cam_from_world.size(); ++i) result.add_node();
    for (const RotationEdge& edge : graph.edges) {
        auto verified = std::make_shared<VerifiedPair>();
        verified->pair = edge.pair;
        verified->geometry.cam2_from_cam1.rotation = edge.cam2_from_cam1;
        verified->geometry.cam2_from_cam1.translation = Eigen::Vector3d::UnitX();
        verified->geometry.matrix = essential_matrix(verified->geometry.cam2_from_cam1);
        const auto inliers = static_cast<std::uint32_t>(edge.weight);
        for (std::uint32_t i = 0; i < inliers; ++i) verified->geometry.inliers.push_back({i, i});
        result.add_edge(edge.pair.first, edge.pair.second, edge.weight, std::move(verified));
    }
    return result;
}

}  // namespace psfm::synthetic
