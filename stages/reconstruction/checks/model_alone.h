// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "graph/reconstruction.h"
#include "stages/reconstruction/checks/camera_ties.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// A model with ties of its own, to be adjusted and compared: its images without their edges, so
/// that nothing is added to it. Stays where it is made: the working model points into it.
struct ModelAlone {
    ClusterProblem problem;
    CorrespondenceGraph matches;
    WorkingModel model;

    /// @param with_edges  the problem of the model, without ties
    ModelAlone(const std::shared_ptr<const Reconstruction>& placed,
               const ClusterProblem& with_edges, const CameraTies& ties);
    ModelAlone(const ModelAlone&) = delete;
    ModelAlone& operator=(const ModelAlone&) = delete;
};

}  // namespace psfm
