// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "scheduler/flow/run_session.h"
#include "tools/serve/live_session.h"
#include "tools/serve/upload_store.h"

namespace psfm {

/// What a served session consists of; all outlive the run.
struct ServedParts {
    SessionStore* store = nullptr;
    const SessionConfig* config = nullptr;
    UploadStore* uploads = nullptr;
    LiveSession* live = nullptr;
    SessionObserver* observer = nullptr;
};

/// run_session of what users send, until `stop`. When they take photographs back it is interrupted,
/// the photographs are taken out of the session as `psfm remove --again` does it, and it goes on.
/// @errors those of run_session and remove_images
Result<SessionRun> run_served(const ServedParts& parts, const ExecutionOptions& execution,
                              const PhotoExtractor& extract, const std::atomic<bool>& stop);

}  // namespace psfm
