// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "graph/result.h"
#include "stages/features/photographs/photo_file.h"

namespace psfm {

/// kUnreadable, with the photograph's name and why it is refused.
Error unreadable(const PhotoFile& photo, const std::string& reason);

/// All bytes of a regular file. Never blocks on pipes or devices: only regular files are read.
/// @errors kIo: missing, no permission, or the system cannot read it; kUnreadable: a folder, no
///         regular file, empty, above max_bytes. The message names the photograph and the remedy
/// Thread-safe.
Result<std::vector<std::uint8_t>> read_file_bytes(const PhotoFile& photo, std::uint64_t max_bytes);

/// The content_hash of a photograph (PhotoMetadata) by itself. @errors as above. Thread-safe.
Result<std::uint64_t> content_hash_of(const PhotoFile& photo, std::uint64_t max_bytes);

}  // namespace psfm
