// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "graph/scene.h"

namespace psfm {

/// What a person can do about an image that waits for this reason, in a sentence; empty for kNone.
const char* advice_for(WaitReason reason);

/// What is wrong with a rejected photograph, and what to do: its stored reason taken apart, without
/// the photograph's name at its beginning.
struct RejectionWords {
    std::string reason;
    std::string advice;  ///< empty when the reason holds none
};
RejectionWords split_rejection(const std::string& name, const std::string& stored_reason);

}  // namespace psfm
