// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace psfm {

/// The format's name on the command line.
inline constexpr const char* kDatabaseFormat = "colmap-database";

/// Writes FOLDER/database.db, a COLMAP database of what the session knows before any model is made:
/// cameras as accepted, images, features, descriptors, and all verified pairs. Needs no model.
/// Shows progress on a terminal. A database.db that psfm did not write is left alone.
/// @return the program's exit code; failures have been reported
int export_database(const std::string& session, const std::filesystem::path& folder);

}  // namespace psfm
