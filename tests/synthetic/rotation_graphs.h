// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "graph/ids.h"
#include "graph/view_graph.h"

/// Graphs of relative rotations with planted noise and outliers, for rotation averaging and for
/// what is to find wrong edges. Deterministic for equal options and seed, thread-safe.
namespace psfm::synthetic {

enum class RotationEdgeTruth {
    kRight,       ///< the true relative rotation, up to noise
    kRandom,      ///< an outlier that agrees with nothing
    kConsistent,  ///< an outlier that agrees with the other consistent ones: a look-alike
};

struct RotationEdge {
    ImagePair pair;
    Eigen::Quaterniond cam2_from_cam1 = Eigen::Quaterniond::Identity();  ///< "1" is pair.first
    double weight = 1.0;                                                 ///< as inlier counts are
    RotationEdgeTruth truth = RotationEdgeTruth::kRight;
};

/// Invariant: edges ascending by pair, each pair at most once.
struct RotationGraph {
    std::vector<Eigen::Quaterniond> cam_from_world;  ///< true rotations
    std::vector<RotationEdge> edges;
};

struct RandomRotationOptions {
    std::uint32_t nodes = 30;
    /// Edges beside those of a random spanning tree, as a part of all possible ones.
    double density = 0.2;
    double noise_sigma_deg = 0.5;
    double outlier_fraction =
        0.1;  ///< of the edges outside the spanning tree; the tree stays right
    double min_weight = 30.0, max_weight = 500.0;
};
/// Connected by right edges; outliers are uniform rotations at least 20 degrees from the truth, and
/// weigh what other edges do.
RotationGraph make_random_rotations(const RandomRotationOptions& options, std::uint64_t seed);

/// A ring of cameras about something with `folds` equal sides, looking inward. Images up to
/// reach_deg apart have a right edge. Images further apart, but within reach_deg of a whole number
/// of sides, look alike: their edge is the rotation that they would have were they on the same
/// side. All these wrong edges agree with one another. Defaults: what SIFT's matches say about
/// temple-341 (docs/datasets.md), where right edges have 850 * exp(-degrees / 11.5) inliers beyond
/// 5 degrees and look-alikes a fifth of that.
struct FoldedRingOptions {
    std::uint32_t nodes = 60;
    std::uint32_t folds = 6;
    double reach_deg = 32.0;             ///< images further apart share nothing true
    double look_alike_reach_deg = 15.0;  ///< how far from a whole number of sides
    double noise_sigma_deg = 0.3;
    double peak_weight = 850.0;
    double decay_deg = 11.5;
    double look_alike_ratio = 0.2;
    double min_weight = 15.0;  ///< lighter edges are left out
};

struct FoldedRing {
    RotationGraph graph;
    /// The other story that the edges tell: all sides laid over the first. Every consistent outlier
    /// but those across the seam between two sides agrees with it, and every right edge within a
    /// side.
    std::vector<Eigen::Quaterniond> folded_cam_from_world;
};
FoldedRing make_folded_ring(const FoldedRingOptions& options, std::uint64_t seed);

/// Angle [deg] between an edge's rotation and the one that the absolute rotations imply.
double edge_error_deg(const RotationEdge& edge,
                      const std::vector<Eigen::Quaterniond>& cam_from_world);

/// Largest angle [deg] between estimated and true rotations after the best common rotation.
double max_rotation_error_deg(const std::vector<Eigen::Quaterniond>& estimated,
                              const std::vector<Eigen::Quaterniond>& truth);

/// The edges as verified pairs: rotation and weight as they are (the inliers are as many made-up
/// matches), translation along x.
ViewGraph make_view_graph(const RotationGraph& graph);

}  // namespace psfm::synthetic
