// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "graph/scene.h"
#include "scheduler/session/weak_model.h"
#include "stages/reconstruction/model/solve_policy.h"

namespace psfm {

/// Why a session of so many images has placed none of them, most likely, and what helps: one line.
/// @param policy  says how many a model takes
std::string why_nothing_is_placed(std::span<const WaitReason> waiting, const SolvePolicy& policy);

/// One line for each way in which a model is weak.
std::vector<std::string> describe(const WeakModel& model);

}  // namespace psfm
