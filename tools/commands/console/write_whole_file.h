// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>

#include "graph/result.h"

namespace psfm {

/// Writes a file whole or not at all: what stood there stays until the new one is complete.
/// @errors kIo, kNoSpace; names the file
Result<void> write_whole_file(const std::filesystem::path& file, std::string_view content);

}  // namespace psfm
