// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

namespace psfm {

/// From now on Ctrl-C (SIGINT) and SIGTERM ask to stop, and the second of them ends the process at
/// once: every commit of a session is atomic, so that nothing that was acknowledged is lost.
/// @return whether that was asked. The same for every call
const std::atomic<bool>& catch_interrupts();

}  // namespace psfm
