// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <system_error>

namespace psfm {

/// What tells a file from what it was when it was last looked at: whoever writes into it, or puts
/// another one in its place, changes one of the two.
struct FileStamp {
    std::int64_t size = 0;         ///< [bytes]
    std::int64_t modified_ns = 0;  ///< by the file system's clock
    bool operator==(const FileStamp&) const = default;
};

/// @return nothing where there is no file, or it cannot be looked at. Thread-safe.
inline std::optional<FileStamp> stamp_of(const std::filesystem::path& file) {
    std::error_code error;
    const auto size = std::filesystem::file_size(file, error);
    if (error) return std::nullopt;
    const auto modified = std::filesystem::last_write_time(file, error);
    if (error) return std::nullopt;
    const auto since_epoch =
        std::chrono::duration_cast<std::chrono::nanoseconds>(modified.time_since_epoch());
    return FileStamp{static_cast<std::int64_t>(size), since_epoch.count()};
}

/// Whether there is no file. One that cannot be looked at, for want of permission, is there.
inline bool is_gone(const std::filesystem::path& file) {
    std::error_code unknown;
    return std::filesystem::status(file, unknown).type() == std::filesystem::file_type::not_found;
}

}  // namespace psfm
