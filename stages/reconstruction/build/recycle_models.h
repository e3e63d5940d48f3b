// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "stages/reconstruction/model/solve_context.h"

namespace psfm {

struct Recycling {
    std::uint32_t joined = 0;           ///< models joined to the first
    std::vector<std::uint32_t> images;  ///< of these, local numbers, ascending
    std::vector<std::uint32_t> joint;   ///< ends of edges from one model to another, ascending
    /// Models that found no place: their images are added one by one.
    std::uint32_t left = 0;
    /// Those of them of which no edge says where they belong: none has enough triangulated points
    /// at both of its ends.
    std::vector<Reconstruction> unrelated = {};
};

/// Images of a model, ascending.
std::vector<ImageId> images_of(const Reconstruction& model);

/// Images of a cluster, ascending.
std::vector<ImageId> members_of(const ClusterProblem& problem);

/// Moves models onto one that is there, each by the similarity that the 3D-3D correspondences of
/// the local graph's edges between them agree on, if the relative rotations it brings about agree
/// with the averaged ones. Models that find no place are tried again after each one that does.
/// Nothing is adjusted; tracks are not fused yet. Deterministic.
Recycling join_models(WorkingModel& model, std::vector<Reconstruction> parts,
                      const SolveContext& context);

/// Loads the problem's recycled models (paper sec. "Cluster Reconstruction", transfer): the first
/// as it is, the others joined to it.
/// REQUIRES: nothing registered in `model` yet, problem.recycled not empty. Deterministic.
Recycling load_recycled(WorkingModel& model, const SolveContext& context);

}  // namespace psfm
