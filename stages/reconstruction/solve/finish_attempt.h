// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stages/reconstruction/checks/contradiction.h"
#include "stages/reconstruction/checks/judge_model.h"
#include "stages/reconstruction/model/solve_context.h"

// From a draft, as it stands, to an attempt.

namespace psfm {

/// Notes that the model as it is has been adjusted so many times.
inline void note_adjusted(SolveDraft& draft, std::uint32_t adjustments) {
    draft.statistics.full_adjustments += adjustments;
    draft.state.images_at_full_adjustment = draft.model.registered_count();
}

/// Notes that a model of so many images has been asked for places.
inline void note_asked_for_places(SolveState& state, std::size_t images) {
    state.images_at_places = static_cast<std::uint32_t>(images);
    state.has_strangers = false;
}

/// A model that nothing in this solve will change any more.
inline SolveAttempt finish_attempt(const SolveDraft& draft, const SolveContext& context) {
    SolveAttempt attempt;
    attempt.model = draft.model.save();
    attempt.state = draft.state;
    attempt.statistics = draft.statistics;
    attempt.contradiction =
        find_contradiction(draft.model, context.graph, context.options.max_contradiction_deg);
    return attempt;
}

}  // namespace psfm
