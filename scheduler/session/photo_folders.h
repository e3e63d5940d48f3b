// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graph/result.h"
#include "storage/session/session_store.h"

namespace psfm {

/// Folders where a session's photographs may lie: the one within the session, of what was sent to
/// `psfm serve`; those that images say they came from; that of the last run.
/// @return those that count first first; they may be gone
/// @errors of the reader
Result<std::vector<std::filesystem::path>> photo_folders(const SessionReader& reader,
                                                         const std::filesystem::path& session);

/// The same of a session of which not everything can be read.
/// @param sources  of its images  @param last_folder  that of the last run, or the database
std::vector<std::filesystem::path> photo_folders(std::span<const ImageSource> sources,
                                                 const std::filesystem::path& last_folder,
                                                 const std::filesystem::path& session);

/// The photograph, in the first of the folders that has it. Names that lead out of a folder, as
/// imported ones may, are nowhere.
std::optional<std::filesystem::path> find_photo(std::span<const std::filesystem::path> folders,
                                                const std::string& name);

}  // namespace psfm
