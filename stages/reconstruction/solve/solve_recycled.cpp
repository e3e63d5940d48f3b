// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/solve_recycled.h"

#include <optional>
#include <utility>

#include "stages/reconstruction/build/join_while_growing.h"
#include "stages/reconstruction/build/recycle_models.h"
#include "stages/reconstruction/build/refine_model.h"
#include "stages/reconstruction/checks/separate_places.h"
#include "stages/reconstruction/model/plan_solve.h"
#include "stages/reconstruction/model/tracks.h"
#include "stages/reconstruction/solve/close_loops.h"
#include "stages/reconstruction/solve/finish_attempt.h"
#include "stages/reconstruction/solve/mend_model.h"

namespace psfm {
namespace {

using Places = std::vector<std::vector<ImageId>>;

SolveKind kind_of(const ClusterProblem& problem) {
    if (problem.settle) return SolveKind::kSettle;
    return problem.recycled.size() > 1 ? SolveKind::kTransfer : SolveKind::kExtend;
}

/// Closes what is open in a model, where that is due, and notes it.
Result<LoopClosing> close_open_loops(SolveDraft& draft, const SolveContext& context) {
    if (!plan_from(draft, context).due.loops) return LoopClosing{};
    const auto closing = close_loops(draft.model, context);
    if (!closing.ok()) return closing.error();
    draft.statistics.full_adjustments += closing->adjustments;
    draft.statistics.closed_loops += closing->adjustments > 0 ? 1 : 0;
    if (closing->shows_one_place)
        note_asked_for_places(draft.state, draft.model.registered_count());
    return closing;
}

/// Adjusts what was joined where it was joined, or all of the model where it has grown enough.
Result<void> adjust_joined(SolveDraft& draft, const Recycling& recycling,
                           const SolveContext& context) {
    const std::size_t adjusted = draft.state.images_at_full_adjustment;
    if (!context.options.policy.full_adjustment.is_due(adjusted + recycling.images.size(),
                                                       adjusted)) {
        const auto locally =
            refine_joined_locally(draft.model, recycling.images, context.refining());
        if (!locally.ok()) return locally.error();
        draft.statistics.local_adjustments += *locally;
        return {};
    }
    const auto adjustments =
        refine_joined(draft.model, recycling, plan_from(draft, context), context.refining());
    if (!adjustments.ok()) return adjustments.error();
    note_adjusted(draft, *adjustments);
    return {};
}

/// Adjusts models that were joined, unless they show different places: what would only come apart
/// again is not adjusted first.
/// @return these places; none: the solve goes on with the model
Result<Places> adjust_joint(SolveDraft& draft, const Recycling& recycling,
                            const SolveContext& context) {
    complete_tracks(draft.model, recycling.joint, context.options.tracks);
    merge_tracks(draft.model, recycling.joint, context.options.tracks);
    const auto closing = close_open_loops(draft, context);
    if (!closing.ok()) return closing.error();
    if (!closing->shows_one_place) {
        auto places =
            separate_places(draft.model.save(), pairs_of(context.problem), context.options.places);
        if (!places.empty()) return places;
        note_asked_for_places(draft.state, draft.model.registered_count());
    }
    if (closing->adjustments > 0) {  // what the joint moved has been adjusted
        note_adjusted(draft, 0);
        return Places{};
    }
    if (const auto adjusted = adjust_joined(draft, recycling, context); !adjusted.ok())
        return adjusted.error();
    return Places{};
}

/// Places anew what contradicts the averaged rotations, where that is due and comes down to a part.
Result<void> mend_bad_configuration(SolveDraft& draft, const SolveContext& context) {
    const Contradiction contradiction =
        find_contradiction(draft.model, context.graph, context.options.max_contradiction_deg);
    if (!is_bad_configuration(contradiction, draft.state, plan_from(draft, context).due,
                              context.options))
        return {};
    if (const auto mended = mend_model(draft, context); !mended.ok()) return mended.error();
    draft.state.images_at_places = 0;  // another model, of as many images
    return {};
}

/// As planned: all of the model, to convergence.
Result<void> settle(SolveDraft& draft, const SolveContext& context) {
    const auto adjustments =
        refine_model(draft.model, context.options.settling, context.refining());
    if (!adjustments.ok()) return adjustments.error();
    note_adjusted(draft, *adjustments);
    return {};
}

}  // namespace

Result<SolveAttempt> solve_recycled(const SolveContext& context,
                                    const CorrespondenceGraph& matches) {
    SolveDraft draft = make_draft(context, matches);
    draft.state = state_of_recycled(context.problem);
    draft.statistics.kind = kind_of(context.problem);
    Places places;
    const auto handle = [&](const Recycling& recycling) -> Result<bool> {
        auto shown = adjust_joint(draft, recycling, context);
        if (!shown.ok()) return shown.error();
        places = *std::move(shown);
        return places.empty();
    };
    const auto grown =
        join_while_growing(draft, load_recycled(draft.model, context), context, handle);
    if (!grown.ok()) return grown.error();
    if (!places.empty()) {
        SolveAttempt attempt = finish_attempt(draft, context);
        attempt.places = std::move(places);
        attempt.statistics.kind = SolveKind::kTransfer;
        return attempt;
    }
    if (const auto mended = mend_bad_configuration(draft, context); !mended.ok())
        return mended.error();
    if (const auto closed = close_open_loops(draft, context); !closed.ok()) return closed.error();
    if (context.problem.settle) {
        if (const auto settled = settle(draft, context); !settled.ok()) return settled.error();
    }
    return finish_attempt(draft, context);
}

}  // namespace psfm
