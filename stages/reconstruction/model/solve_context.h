// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/local_graph.h"
#include "stages/reconstruction/model/plan_solve.h"
#include "stages/reconstruction/model/solve_options.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// What adjusting a model in work reads.
struct RefineContext {
    const SolveOptions& options;
    bool fix_intrinsics = false;
    const std::atomic<bool>* cancel = nullptr;  ///< asked before each step of an adjustment
};

/// What the steps of one solve read.
struct SolveContext {
    const ClusterProblem& problem;
    const LocalGraph& graph;
    const SolveOptions& options;
    const std::atomic<bool>* cancel = nullptr;  ///< as solve_cluster's

    RefineContext refining() const { return {options, problem.fix_intrinsics, cancel}; }
};

/// What they write: a model in work, what the next solve is to know of it, and what was done.
struct SolveDraft {
    WorkingModel model;
    SolveState state = {};
    SolveStatistics statistics = {};
};

/// The plan from where a draft stands.
inline SolvePlan plan_from(const SolveDraft& draft, const SolveContext& context) {
    return plan_solve(context.problem, draft.state, draft.model.registered_count(),
                      context.options.policy);
}

/// Nothing registered yet, intrinsics as in the graph. @param matches  outlive the draft
inline SolveDraft make_draft(const SolveContext& context, const CorrespondenceGraph& matches) {
    SolveDraft draft{WorkingModel(context.problem, matches)};
    draft.model.use_cameras(context.graph.cameras);
    return draft;
}

}  // namespace psfm
