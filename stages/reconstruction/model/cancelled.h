// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "graph/result.h"

namespace psfm {

/// Asked between the steps of a solve, so that it ends soon after it is told to.
/// @param cancel  may be null: never told to
/// @errors kCancelled
inline Result<void> not_cancelled(const std::atomic<bool>* cancel) {
    if (cancel != nullptr && cancel->load())
        return Error{ErrorCode::kCancelled, "stopped on request"};
    return {};
}

}  // namespace psfm
