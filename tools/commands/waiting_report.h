// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "graph/scene.h"
#include "scheduler/session/weak_model.h"

namespace psfm {

/// Why a session of so many images has placed none of them, most likely, and what helps: one line.
/// @param mu_min  images that a model takes
std::string why_nothing_is_placed(std::span<const WaitReason> waiting, std::uint32_t mu_min);

/// One line for each way in which a model is weak.
std::vector<std::string> describe(const WeakModel& model);

}  // namespace psfm
