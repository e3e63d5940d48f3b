// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"

namespace psfm {

/// When a model of more than SolvePolicy::affordable_up_to has loops that are open, and how they
/// are closed; smaller ones are adjusted as a whole when they grow, and hardly drift. All ours,
/// tuned on the simulated town; figures: docs/accuracy.md, "Loops", and
/// docs/notebook/2026-11-25-loops.md; docs/options.md says of which there are none.
struct LoopOptions {
    /// Open edges that a model must have; 0: loops are never closed, as in the paper. Lowered:
    /// single wrong edges bend models; raised: loops that close with few images stay open.
    std::uint32_t min_open_edges = 10;
    /// Matches of an edge whose features both belong to points, before it says anything.
    std::uint32_t min_matches = 10;
    /// An edge is open when hardly any of these have a point in common ...
    double max_shared_part = 0.25;
    /// ... and the two points of a match are so far apart, in the median, over their depth.
    /// Lowered: points that adjustment brings together are taken for loops; raised: loops that are
    /// open by less stay open.
    double min_gap = 0.05;
    /// Edges that hold an image in place, those with most common points first. Raised: slower;
    /// lowered: streets bend where cross streets hold them.
    std::uint32_t edges_per_image = 8;
    /// Steps of the pose graph. Few do: what is left is for the adjustment. Raised: slower, and
    /// bent more where a loop may also close by turning at one image.
    std::uint32_t max_iterations = 5;
    /// Residual (pose_graph_residual) from which an edge is still open after that, or torn. Raised:
    /// wrong edges bend models further.
    double max_residual = 0.1;
    /// Part of the observations that closing may cost: it would not, were the loop a true one.
    double max_lost_observations = 0.01;
    /// Residual from which an edge that holds has been strained: some pixels. Images of strained
    /// edges are adjusted. Lowered: more are, soon all of the model; the rest is for settling.
    double min_strain = 0.004;
    /// Edges that are torn, at most, over those that closed. Raised: wrong edges tear models apart.
    double max_torn = 0.1;
    /// Huber's scale of the pose graph that spreads drift: so large that hardly a residual is an
    /// outlier. Lowered: what is wrong gathers at few places, as it does without drift.
    double drift_loss_scale = 1.0;
    /// Images that move as one where nothing is strained. Raised: breaks are looked for at fewer
    /// places; lowered: slower. Not tuned.
    std::uint32_t images_per_group = 16;
};

/// @errors kInvalidArgument
Result<void> validate(const LoopOptions& options);

}  // namespace psfm
