// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "graph/result.h"
#include "stages/algorithms/averaging/relative_direction.h"

namespace psfm {

struct PositionAveragingOptions {
    /// Steps of the convex start at most. Lowered: the refinement starts further off, and may end
    /// in a local optimum. Ours: planted cases take 10 to 40.
    std::uint32_t max_start_iterations = 60;
    /// The start ends when a step lowers its cost by a smaller part. Ours; not tuned.
    double start_convergence = 1e-3;
    /// Residual from which the loss of the refinement departs from least squares [deg]. Raised:
    /// outliers pull more; lowered: true edges with noise lose their say. Wilson & Snavely 2014: a
    /// chord of 0.1.
    double loss_scale_deg = 5.7;
    /// Iterations of the refinement at most. Ours; not tuned.
    int max_refinement_iterations = 100;
    /// Lengths of edges that meet must be known relative to one another to this part. Raised:
    /// nodes on a line, whose distances the directions hardly determine, are placed; lowered: far
    /// ends of sparse graphs are not. Ours: of 30 nodes on an exact line with noise, up to 9 are
    /// placed with 0.1, up to 24 with 0.3; 0.03 loses rings with 1 degree of noise.
    double max_length_sigma = 0.1;
    /// Noise of a direction at least [deg], when lengths are judged; what the residuals say where
    /// that is more. Lowered: in data without noise, shorter deviations from a line count. Ours;
    /// not tuned.
    double min_noise_deg = 0.1;
};

/// @errors kInvalidArgument
Result<void> validate(const PositionAveragingOptions& options);

struct PositionAveraging {
    /// By node; nothing where the directions do not determine it. Gauge: the mean of the positions
    /// is the origin, the median length of the edges between them is 1.
    std::vector<std::optional<Eigen::Vector3d>> position;
    /// By edge: angle between the measured direction and that of the positions.
    std::vector<std::optional<double>> residual_deg;
    std::uint32_t placed = 0;  ///< nodes with a position
    double noise_deg = 0.0;    ///< standard deviation of a direction, from the residuals' median
};

/// Positions from directions. Start: least unsquared deviations (Ozyesil & Singer, Robust Camera
/// Location Estimation by Convex Programming, CVPR 2015), convex. Then the chordal distances of
/// the directions with a Huber loss (Wilson & Snavely, ECCV 2014, sec. 4), with Ceres on one
/// thread.
///
/// Only the largest part is placed in which the directions determine all positions up to one
/// shift and one scale (parallel rigidity). What is judged is not the graph but the solution: the
/// uncertainty of the lengths under the noise of the directions, so that cameras on a line, whose
/// graph is rigid in general position, are found, too. Of these a few neighbours may be placed all
/// the same, where noise looks like shape.
///
/// @param edges any number, several between two nodes allowed
/// @errors kInvalidArgument (see check_directions), kDegenerate (fewer than three nodes can be
/// placed), kInternal (the normal matrix cannot be factored)
/// Deterministic: bitwise equal for equal inputs. Thread-safe.
Result<PositionAveraging> average_positions(std::span<const RelativeDirection> edges,
                                            std::uint32_t node_count,
                                            const PositionAveragingOptions& options);

}  // namespace psfm
