// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "stages/reconstruction/checks/camera_ties.h"
#include "stages/reconstruction/checks/tied_model.h"
#include "stages/reconstruction/model/solve_options.h"

namespace psfm {

struct TieVerdict {
    CameraTies ties;
    /// The model with these ties, released focal lengths where they deviate: not adjusted.
    std::shared_ptr<const Reconstruction> model;
    std::vector<ReleasedCamera> released;  ///< by kind, ascending by camera
};

/// Asks a finished model which of the cameras of a kind are one. It is adjusted with all of them
/// tied, then with each by itself. Where a scene hardly tells focal lengths (a plane from above, a
/// narrow view) these wander and gain nothing: so a camera only leaves the others when its
/// observations are explained clearly better, and its focal length is another one. Then all of its
/// kind have one of the fewest zooms with which none leaves any more; where no few zooms explain
/// them, they are tied to those whose focal lengths are near theirs. Ties that the model comes with
/// do not count: what was decided with fewer images is decided anew.
/// @param problem  as accepted, not tied
/// @param ties  those of the model: what becomes of them when nothing can be found out
/// Deterministic.
TieVerdict judge_ties(const std::shared_ptr<const Reconstruction>& model,
                      const ClusterProblem& problem, const CameraTies& ties,
                      const SolveOptions& options);

}  // namespace psfm
