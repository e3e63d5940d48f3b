// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/solve_new.h"

#include <utility>
#include <vector>

#include "stages/reconstruction/build/grow_model.h"
#include "stages/reconstruction/build/initialize_model.h"
#include "stages/reconstruction/build/refine_model.h"
#include "stages/reconstruction/build/solve_global.h"
#include "stages/reconstruction/solve/finish_attempt.h"

namespace psfm {
namespace {

bool is_cancelled(const Error& error) {
    return error.code == ErrorCode::kCancelled;
}

/// All images at once, the rest added.
Result<SolveAttempt> solve_globally(const SolveContext& context,
                                    const CorrespondenceGraph& matches) {
    SolveDraft draft = make_draft(context, matches);
    const auto start = initialize_globally(draft.model, context);
    if (!start.ok()) return start.error();
    draft.statistics.is_global = true;
    draft.statistics.registered = start->placed;
    draft.statistics.full_adjustments = start->full_adjustments;
    draft.state.images_at_full_adjustment = start->placed;
    if (const auto grown = grow_model(draft, context); !grown.ok()) return grown.error();
    if (draft.model.registered_count() > start->placed) {
        const auto adjustments =
            refine_changed_model(draft.model, plan_from(draft, context).effort, context.refining());
        if (!adjustments.ok()) return adjustments.error();
        note_adjusted(draft, *adjustments);
    }
    return finish_attempt(draft, context);
}

/// A model of more images than the best so far is adjusted, and takes its place: to convergence
/// once no photograph follows, for then it is compared with others. So does what it becomes with
/// the images that find a place only then.
/// @errors kCancelled
Result<void> take_if_larger(SolveDraft& draft, const SolveContext& context, SolveAttempt& best) {
    const RefinementOptions& refinement =
        context.problem.concluding ? context.options.settling : context.options.growth;
    while (draft.model.registered_count() > best.model.images.size()) {
        const auto adjustments = refine_model(draft.model, refinement, context.refining());
        // Expected: a start that cannot be adjusted is none, and the best so far stays
        if (!adjustments.ok())
            return is_cancelled(adjustments.error()) ? adjustments.error() : Result<void>();
        note_adjusted(draft, *adjustments);
        if (draft.model.registered_count() <= best.model.images.size()) break;
        best = finish_attempt(draft, context);
        const auto grown = grow_model(draft, context);
        // Expected: the adjusted start stays without what could not be added
        if (!grown.ok()) return is_cancelled(grown.error()) ? grown.error() : Result<void>();
    }
    return {};
}

/// From the best pair.
Result<SolveAttempt> solve_incrementally(const SolveContext& context,
                                         const CorrespondenceGraph& matches) {
    const std::size_t members = context.problem.images.size();
    SolveAttempt best;
    std::vector<bool> used(members, false);
    for (std::uint32_t start = 0; start < context.options.initialization.max_starts; ++start) {
        SolveDraft draft = make_draft(context, matches);
        const auto seed = initialize_model(draft.model, context.graph, used, context.options);
        if (!seed.ok()) break;  // Expected: no further pair starts a model
        draft.state.images_at_full_adjustment = draft.model.registered_count();
        draft.statistics.registered = draft.model.registered_count();
        const auto grown = grow_model(draft, context);
        // Expected: a start that degenerates leads nowhere; another one may
        if (!grown.ok() && grown.error().code != ErrorCode::kDegenerate) return grown.error();
        if (grown.ok()) {
            const auto taken = take_if_larger(draft, context, best);
            if (!taken.ok()) return taken.error();
        }
        const double enough = context.options.reset.enough * static_cast<double>(members);
        if (static_cast<double>(best.model.images.size()) > enough) break;
        used[seed->first] = used[seed->second] = true;
        for (std::uint32_t image = 0; image < draft.model.image_count(); ++image) {
            if (draft.model.registered(image)) used[image] = true;
        }
    }
    return best;
}

}  // namespace

Result<SolveAttempt> solve_new(SolveStart start, const SolveContext& context,
                               const CorrespondenceGraph& matches) {
    if (start == SolveStart::kGlobal) {
        auto attempt = solve_globally(context, matches);
        // Expected: what could not be started globally may still be grown
        if (attempt.ok() || is_cancelled(attempt.error())) return attempt;
    }
    return solve_incrementally(context, matches);
}

}  // namespace psfm
