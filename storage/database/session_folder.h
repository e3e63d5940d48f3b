// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "graph/result.h"

namespace psfm {

// Names inside a session folder (FORMAT.md section 1; persistent).
inline constexpr const char* kMarkerFile = "psfm-session";
inline constexpr const char* kLockFile = "writer.lock";
inline constexpr const char* kLockFirstLine = "psfm session lock";
inline constexpr const char* kDatabaseFolder = "db";
inline constexpr const char* kReadersFolder = "secondary";
inline constexpr const char* kReplacedDatabaseFolder = "db-damaged";
inline constexpr int kSessionFormat = 1;  // Format: version of a session's folder

enum class FolderState {
    kNew,      ///< missing, empty, or left by an interrupted creation: a session may be made there
    kSession,  ///< marked as a session of a format that this program reads
};

/// What a folder is; changes nothing.
/// @errors kInvalidArgument (something else), kVersion (newer format), kDamaged (unreadable
/// marker), kIo
Result<FolderState> inspect_session_folder(const std::filesystem::path& folder);

/// What lies in a session's folder and is not the store's own, by name: photographs that were sent,
/// users, logs.
std::vector<std::string> entries_of_others(const std::filesystem::path& session);

/// Makes the folder a session; synced. @errors kNoSpace, kIo
Result<void> write_session_marker(const std::filesystem::path& folder);

/// A path between single quotes, for messages.
std::string quoted(const std::filesystem::path& path);

/// "session '/path'", for messages.
std::string session_label(const std::filesystem::path& folder);

}  // namespace psfm
