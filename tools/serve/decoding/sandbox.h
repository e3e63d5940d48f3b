// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "graph/result.h"
#include "stages/features/feature_options.h"
#include "stages/features/photographs/photo_file.h"
#include "stages/features/run_features.h"

namespace psfm {

// Photographs of strangers are decoded by a process of their own, which may read files and write to
// its standard output, and nothing else: no network, no other process, no file. What breaks it is
// a rejected photograph.

/// Guard: what a photograph may cost that was made to cost much.
inline constexpr int kMostDecodeSeconds = 180;

/// The features stage in such a process. The same result as run_features, and its errors; kInternal
/// where the process broke, was stopped for its limits, or said what cannot be.
/// @param preset   of the session, which sets the options
/// @param seconds  on the clock that the process may take
/// Thread-safe.
Result<ExtractedPhoto> extract_in_sandbox(const PhotoFile& photo, const std::string& preset,
                                          int seconds = kMostDecodeSeconds);

/// A JPEG of at most 320 pixels a side without any metadata, made in such a process; nothing when
/// it cannot be made. Thread-safe.
std::optional<std::string> thumbnail_in_sandbox(const std::filesystem::path& photo);

/// The other side: what `psfm decode-photograph` does. @return its exit code
int sandboxed_extract(const PhotoFile& photo, const FeatureOptions& options);
int sandboxed_thumbnail(const std::filesystem::path& photo);

/// Gives up, for this process and for good, all that decoding does not need; files and connections
/// that are open, but for the standard ones, are closed. @return false: it could not be done, and
/// nothing of a stranger's should be read
bool enter_sandbox();

}  // namespace psfm
