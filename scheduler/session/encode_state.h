// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <string>

#include "graph/result.h"
#include "scheduler/session/messages.h"
#include "scheduler/session/session_state.h"
#include "stages/reconstruction/model/cluster_problem.h"

namespace psfm {

// Small values that the store keeps as JSON text.

/// Solution state: what the next solve recycles beside the model.
struct StoredSolveState {
    SolveState state;
    bool settled = false;
};
std::string encode_solve_state(const StoredSolveState& state);
/// Fields that are missing, as in sessions of earlier programs, take their defaults, and so does an
/// empty text: a full adjustment comes early then, nothing is lost. Unknown ones are left alone.
/// @errors kDamaged (no JSON object, or a field that holds something else)
Result<StoredSolveState> decode_solve_state(const std::string& json);

/// Counts and waiting images of a published version, for `status`.
struct SceneSummary {
    SessionCounts counts;
    std::vector<std::pair<ImageId, WaitReason>> waiting;
    std::deque<PastEvent> events;      ///< oldest first
    std::vector<WeakModel> weak = {};  ///< ascending by cluster
};
std::string encode_summary(const SceneSummary& summary);
/// @errors kDamaged
Result<SceneSummary> decode_summary(const std::string& json);

}  // namespace psfm
