// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "stages/features/feature_options.h"
#include "stages/features/photographs/photo_container.h"
#include "stages/features/photographs/photo_file.h"

namespace psfm {

/// What run_features() takes of memory at its peak, no less [bytes].
/// @param file_bytes  length of the file
std::size_t extraction_bytes(const PhotoSize& size, std::uint64_t file_bytes,
                             const FeatureOptions& options);

/// The same by the first bytes of the file, where these tell the size; else by the file's length.
/// Files that cannot be read take nothing: that is told when they are. Thread-safe.
std::size_t extraction_bytes(const PhotoFile& photo, const FeatureOptions& options);

}  // namespace psfm
