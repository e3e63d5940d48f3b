// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "graph/result.h"

namespace psfm {

/// Whether a session may be exported into a folder, there or not; makes nothing.
/// @errors kInvalidArgument: it is a file, leads to none, or is the session or within it
Result<void> check_output_folder(const std::filesystem::path& output,
                                 const std::filesystem::path& session);

}  // namespace psfm
