// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/local_graph.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// Compares a model with the averaged rotations, which do not depend on the order in which its
/// images were added (paper sec. "Detection of Bad Configurations", rho_l): over the local graph's
/// edges between registered images, the angle between averaged and reconstructed relative rotation.
/// @param max_deg  from which an edge counts as contradicting
Contradiction find_contradiction(const WorkingModel& model, const LocalGraph& graph,
                                 double max_deg);

/// The parts of a model that chains of agreeing edges hold together, largest first: every edge
/// between two of them contradicts.
/// @return registered images, local, each part ascending
std::vector<std::vector<std::uint32_t>> agreeing_parts(const WorkingModel& model,
                                                       const LocalGraph& graph, double max_deg);

/// The images that a contradiction comes down to (ours): those that no chain of agreeing edges
/// joins to the largest part of the model, and within that part those whose edges contradict most,
/// until none is left that does. A model that is folded gives a whole side of the fold.
/// @return local images, ascending
std::vector<std::uint32_t> contradicting_images(const WorkingModel& model, const LocalGraph& graph,
                                                double max_deg);

}  // namespace psfm
