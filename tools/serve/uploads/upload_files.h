// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace psfm {

// The disk, as uploads want it.

/// @return false: what is in the folder may not outlive the machine
bool sync_folder(const std::filesystem::path& folder);

/// Where the thumbnail of a photograph of the session is kept.
std::filesystem::path thumbnail_file(const std::filesystem::path& session, const std::string& name);

/// Appended, or the file is as long as it was.
/// @param durably  and on the disk, too
bool append_line(const std::filesystem::path& file, const std::string& line, bool durably);

struct PhotoContent {
    std::string sha256;
    std::optional<std::string_view> extension;  ///< nothing: it is no photograph
    std::uint64_t bytes = 0;
};
/// Nothing when the file cannot be opened.
std::optional<PhotoContent> read_content(const std::filesystem::path& file);

}  // namespace psfm
