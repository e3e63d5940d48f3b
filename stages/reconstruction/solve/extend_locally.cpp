// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/extend_locally.h"

#include <algorithm>
#include <vector>

#include "stages/reconstruction/build/join_while_growing.h"
#include "stages/reconstruction/build/recycle_models.h"
#include "stages/reconstruction/build/refine_model.h"
#include "stages/reconstruction/checks/contradiction.h"
#include "stages/reconstruction/checks/separate_places.h"
#include "stages/reconstruction/model/local_graph.h"
#include "stages/reconstruction/model/plan_solve.h"
#include "stages/reconstruction/model/surroundings.h"

namespace psfm {
namespace {

/// Images of the result that the recycled model did not have.
std::vector<ImageId> added_images(const Reconstruction& before, const Reconstruction& after) {
    std::vector<ImageId> added;
    for (const RegisteredImage& image : after.images) {
        if (before.find(image.image) == nullptr) added.push_back(image.image);
    }
    return added;
}

}  // namespace

Result<std::optional<SolveAttempt>> extend_locally(const ClusterProblem& problem,
                                                   const SolveOptions& options,
                                                   const std::atomic<bool>* cancel) {
    const std::optional<SolveAttempt> with_all;
    if (places_others_than(*problem.recycled.front(), members_of(problem))) return with_all;
    const auto surroundings = surroundings_of_new_images(problem, options.max_surroundings);
    if (!surroundings) return with_all;
    const ClusterProblem& part = surroundings->problem;

    const auto graph = make_local_graph(part, options);
    if (!graph.ok()) return graph.error();
    const CorrespondenceGraph matches = correspondences_of(part, *graph);
    const SolveContext context{part, *graph, options, cancel};
    SolveDraft draft = make_draft(context, matches);
    draft.state = state_of_recycled(problem);
    const auto adjust_joint = [&](const Recycling& recycling) -> Result<bool> {
        const auto adjustments =
            refine_joined_locally(draft.model, recycling.images, context.refining());
        if (!adjustments.ok()) return adjustments.error();
        draft.statistics.local_adjustments += *adjustments;
        return true;
    };
    const auto grown =
        join_while_growing(draft, load_recycled(draft.model, context), context, adjust_joint);
    if (!grown.ok()) return grown.error();

    const Reconstruction& before = *problem.recycled.front();
    const Reconstruction after = draft.model.save();
    SolveAttempt attempt;
    attempt.state = draft.state;
    attempt.statistics = draft.statistics;
    attempt.model = put_back(before, *surroundings, after);
    attempt.succession = Succession{problem.recycled.front(), surroundings->is_inside};
    attempt.contradiction = find_contradiction(draft.model, *graph, options.max_contradiction_deg);
    if (reason_to_reset(attempt, problem, options)) return with_all;
    attempt.state.has_strangers =
        attempt.state.has_strangers ||
        may_show_another_place(attempt.model, after.points, added_images(before, attempt.model),
                               options.places);
    const std::size_t placed = attempt.model.images.size();
    const DueQuestions due = plan_solve(problem, attempt.state, placed, options.policy).due;
    if (!attempt.state.has_strangers || !due.places) attempt.places.emplace();
    attempt.statistics.kind =
        problem.recycled.size() > 1 ? SolveKind::kTransfer : SolveKind::kExtend;
    attempt.statistics.removed_edges = graph->removed_edges;
    return std::optional(std::move(attempt));
}

}  // namespace psfm
