// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stages/reconstruction/model/solve_context.h"

namespace psfm {

/// Resets the images that a contradiction comes down to (ours; the paper resets whole clusters,
/// which stays for everything else). When they are few, takes them out and adds them again, now
/// that more of the scene is known than when they were placed. When they are many, and the model
/// large, its parts that agree within themselves are joined again as the edges between them say
/// now; that is kept when at least half of the contradiction goes, and hardly an image.
/// Sets the draft's statistics.reset, and notes in its state what contradiction is left. When that
/// is too much, the model stays a bad configuration.
/// @errors those of grow_model and refine_model
Result<void> mend_model(SolveDraft& draft, const SolveContext& context);

}  // namespace psfm
