// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "graph/result.h"
#include "stages/reconstruction/solve_with_ties.h"

namespace psfm {

/// What speaks for a model and against it.
struct ModelScore {
    std::uint32_t images = 0;
    std::uint32_t observations = 0;  ///< within one place each, where the model shows several
    std::uint32_t regions = 0;       ///< compared (compare_by_region)
    std::uint32_t missing = 0;
    std::uint32_t contradicting = 0;  ///< pairs
    std::uint32_t denied = 0;         ///< strong edges of which the model explains next to nothing

    double missing_part() const {
        return static_cast<double>(missing) / (regions > 0 ? regions : 1);
    }
    bool operator==(const ModelScore&) const = default;
};

/// Whether one model is to take the place of another: it places as many images, and clearly less is
/// missing from it; or no more is missing, and it explains more.
bool is_better(const ModelScore& other, const ModelScore& best);

/// A cluster whose model was chosen so, without the edges that it denies: what is solved on from it
/// is not led back by these. Nothing: all of them count.
std::optional<ClusterProblem> as_reconsidered(const ClusterProblem& problem);

/// Looks for a better model of a cluster whose model is doubted: where pairs of its images
/// contradict it (missing_regions.h), it denies one of their strongest edges, or it shows several
/// places. A new start is tried, and cuts: the model is taken apart where most of what contradicts
/// it lies between the parts, the edges that held them together are left out, and it is joined
/// again by the edges that it left unexplained; the best is cut again. A local search over what can
/// be believed, as that of Jiang, Tan & Cheong (CVPR 2012) over spanning trees. What the early
/// images decided is so decided again by all of them, and an ambiguous scene ends the same in every
/// order.
/// @param attempt  of `problem`, by `solve`
/// @param solve  of problems like this one, with other models to start from and fewer edges
/// @return the best one; its state notes for how many images it was looked for
/// @errors kCancelled
/// Deterministic where `solve` is.
Result<SolveAttempt> reconsider_model(const ClusterProblem& problem, SolveAttempt attempt,
                                      const SolveOptions& options, const AttemptSolve& solve);

}  // namespace psfm
