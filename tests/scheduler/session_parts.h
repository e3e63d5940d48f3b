// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "graph/result.h"
#include "stages/evaluation/named_pose.h"
#include "storage/session/session_store.h"

namespace psfm::test {

/// The published poses of a session, by connected part, in the world: each part has a frame of its
/// own. @errors those of the store
Result<std::map<std::uint32_t, std::vector<NamedPose>>> parts_of(const SessionReader& session);

}  // namespace psfm::test
