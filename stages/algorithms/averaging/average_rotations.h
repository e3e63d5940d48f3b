// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/result.h"

namespace psfm {

/// A measured rotation between two cameras: x_j = j_from_i * x_i (directions).
struct RelativeRotation {
    std::uint32_t i = 0;
    std::uint32_t j = 0;
    Eigen::Quaterniond j_from_i = Eigen::Quaterniond::Identity();
    double weight = 1.0;  ///< how much it counts: verified inliers, in the paper
};

/// How the error of one edge, a vector of three angles, enters the L1 sum.
enum class RotationNorm : std::uint8_t {
    kLength,       ///< its length: the result does not depend on the axes of the reference frame
    kCoordinates,  ///< sum of absolute coordinates (Chatterjee & Govindu 2013)
};

/// Loss of the refinement by iteratively reweighted least squares, r in units of loss_scale_deg.
enum class RotationLoss : std::uint8_t {
    kL12,           ///< sqrt(r): between L1 and L0 (Chatterjee & Govindu 2013's l_1/2)
    kHuber,         ///< quadratic, then linear
    kCauchy,        ///< log(1 + r^2)
    kGemanMcClure,  ///< r^2 / (1 + r^2): lets go of far-off edges altogether
};

struct RotationAveragingOptions {
    /// Edges count weight^weight_power. 0: all alike. Raised: strong edges decide alone; an image
    /// whose only strong edge is wrong is lost. 1: paper ("edge weighting depending on the number
    /// of verified correspondences"). 2 with strongest_edges_per_node 10 keeps the temple from
    /// folding (docs/look-alikes.md, "Rotations").
    double weight_power = 1.0;
    /// Only each node's so many strongest edges (and the spanning tree) pull at the rotations;
    /// residuals are given for all. 0: all edges, as in the paper. Lowered: weak edges, right or
    /// wrong, have no say.
    std::uint32_t strongest_edges_per_node = 0;
    /// Start: parts of the graph are joined as most of the edges between them agree within so many
    /// degrees (rotations_by_consensus). 0: as the strongest edge has it, the maximum spanning tree
    /// of the paper. Raised: noisy parts find an agreement, and different wrong edges one another.
    double consensus_deg = 0.0;
    /// An edge's vote counts weight^vote_power when parts are joined so. Raised: one strong wrong
    /// edge turns two parts; lowered: where half of all edges are wrong and agree, their number
    /// does. Ours, on a simulated temple and quad-streams (docs/look-alikes.md, "Rotations").
    double vote_power = 3.0;
    /// Parts that were joined so are asked again when all edges around them have a say, and turned
    /// where what speaks for another rotation is so many times what holds them, the strongest edge
    /// of each left out (turn_parts). 0: never asked. Raised: a part that one wrong edge turned
    /// stays so; lowered: where about half of all edges are wrong and agree, it is theirs to
    /// decide. Ours, on ioniq5 reduced to 800 pixels, where a reflection's edge is strongest;
    /// judged on the other collections, quad-streams and 96 parts of scenes with look-alikes.
    double turn_again_factor = 0.0;
    RotationNorm norm = RotationNorm::kLength;
    /// Linearisations; 0 leaves the rotations of the spanning tree. Each costs up to
    /// max_solver_iterations. Ours: planted cases take 3 to 14.
    std::uint32_t max_iterations = 20;
    /// Ends the iterations when no rotation changes by more [deg]. Raised: coarser rotations.
    double convergence_deg = 0.01;
    /// Steps of the alternating direction method in one linearisation. Lowered: more
    /// linearisations, then inexact optima. Ours: 1000 nodes with 20,000 edges, a fifth of them
    /// wrong, take 0.23 s in all with 100, and the same with
    /// 30 or 300.
    std::uint32_t max_solver_iterations = 100;
    /// Linearisations with reweighted least squares after L1; 0: none, as in the paper, which needs
    /// outliers rejected and no more. With max_iterations 0 and Geman-McClure it refines the
    /// spanning tree at once, which keeps folded rings open (see average_rotations_test).
    std::uint32_t refine_iterations = 0;
    RotationLoss loss = RotationLoss::kGemanMcClure;
    /// Residual from which the loss departs from least squares [deg]. Raised: outliers pull more.
    /// Lowered: noisy true edges are let go. 5 deg: Chatterjee & Govindu 2018.
    double loss_scale_deg = 5.0;
};

/// @errors kInvalidArgument
Result<void> validate(const RotationAveragingOptions& options);

struct RotationAveraging {
    /// By node: the rotation of cam_from_cluster. Each connected component has its own reference
    /// frame, that of its node with the smallest index, whose rotation is the identity.
    std::vector<Eigen::Quaterniond> node_from_reference;
    std::vector<double> residual_deg;  ///< by edge: angle between measured and averaged rotation
    std::vector<double> start_residual_deg;  ///< the same for the start
    std::vector<std::uint32_t> component;    ///< by node; 0, 1, … ascending by smallest node
    std::uint32_t component_count = 0;
    std::uint32_t iterations = 0;  ///< linearisations done, the most over the components
};

/// Robust averaging of relative rotations (paper sec. "Robust Rotation Averaging"; Chatterjee &
/// Govindu, Efficient and Robust Large-Scale Rotation Averaging, ICCV 2013): rotations from the
/// maximum spanning tree by weight, then repeated L1 minimisation of the linearised errors in the
/// Lie algebra. Each linear problem is solved by ADMM, whose normal matrix, the graph's Laplacian
/// with one node fixed, is factored once. Differs from the publication in the norm (see
/// RotationNorm) and in step control: a linearisation that does not lower the L1 sum is halved
/// until it does.
///
/// The L1 optimum is no protection against wrong edges that agree with one another (the
/// temple of docs/look-alikes.md): see weight_power and strongest_edges_per_node.
///
/// @param edges any number, several between two nodes allowed; nodes without edges are components
/// of their own
/// @errors kInvalidArgument (i == j, node out of range, weight not positive, rotation not finite or
/// zero) Deterministic: bitwise equal for equal inputs. Thread-safe.
Result<RotationAveraging> average_rotations(std::span<const RelativeRotation> edges,
                                            std::uint32_t node_count,
                                            const RotationAveragingOptions& options);

/// Edges whose residual is at most max_deg (the paper's rho_g,max): indices, ascending.
std::vector<std::uint32_t> edges_within(const RotationAveraging& averaging, double max_deg);

}  // namespace psfm
