// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "graph/result.h"
#include "storage/session/session_store.h"

namespace psfm {

struct ReplayOptions {
    /// Versions shown at most, evenly spread over all that are kept. Higher: more to read.
    std::size_t most_versions = 400;
    /// A camera that has moved by less of the session's extent stays where it was shown. Ours.
    double tolerance = 0.003;
};

/// The poses of a session's versions, each as what has changed since the one before
/// (docs/serve.md, "Replay"); empty when no version is kept. No points: each carries when it was
/// born.
/// @errors those of the store
Result<std::string> replay_bytes(const SessionReader& session, const ReplayOptions& options = {});

}  // namespace psfm
