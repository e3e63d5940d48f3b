// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <span>

#include "graph/image.h"
#include "graph/result.h"
#include "storage/session/session_store.h"

namespace psfm {

/// Whether a session may be exported into a folder, there or not; makes nothing.
/// @errors kInvalidArgument: it is a file, leads to none, or is the session or within it
Result<void> check_output_folder(const std::filesystem::path& output,
                                 const std::filesystem::path& session);

/// Whether it may be exported there as far as the next `psfm run` goes, which looks for photographs
/// in a folder and below, and passes over what psfm exported.
/// @param photo_folder  of that run; empty: none
/// @param images  named within it
/// @errors kInvalidArgument: it is the photographs' folder, or one within that has some
Result<void> check_apart_from_photographs(const std::filesystem::path& output,
                                          const std::filesystem::path& photo_folder,
                                          std::span<const Image> images);
/// The same of every folder that the session's photographs may lie in: photo_folders().
/// @errors those of the reader, too
Result<void> check_apart_from_photographs(const std::filesystem::path& output,
                                          const SessionReader& reader,
                                          const std::filesystem::path& session);

}  // namespace psfm
