// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "graph/scene.h"
#include "stages/reconstruction/model/solve_policy.h"

namespace psfm {

/// Why a session of so many images has placed none of them, most likely, and what helps: one line.
/// @param policy  says how many a model takes
std::string why_nothing_is_placed(std::span<const WaitReason> waiting, const SolvePolicy& policy);

}  // namespace psfm
