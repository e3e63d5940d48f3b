// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "graph/result.h"
#include "scheduler/flow/run_session.h"
#include "scheduler/session/session_config.h"
#include "stages/evaluation/named_pose.h"

namespace psfm::test {

/// What became of another program's features and matches.
struct ImportedSession {
    SessionRun run;
    std::vector<SessionEvent> events;
    /// By connected part, in the world: each has a frame of its own.
    std::map<std::uint32_t, std::vector<NamedPose>> parts;
};

/// Takes a database through the engine as `psfm import --deterministic` does, with two threads.
/// @param config  its order: of arrival; empty: by name. Cameras, database and determinism are set
/// @param session  of a new session
/// @errors those of the database, the store and the session
Result<ImportedSession> import_database(const std::filesystem::path& database,
                                        const std::filesystem::path& session, SessionConfig config);

}  // namespace psfm::test
