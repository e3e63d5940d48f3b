// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/unfinished_uploads.h"

#include <charconv>
#include <chrono>

namespace psfm {

namespace fs = std::filesystem;

UnfinishedUploads UnfinishedUploads::found_in(const fs::path& folder) {
    constexpr auto kAbandoned = std::chrono::hours(24);  // Guard: phones go on within a day
    UnfinishedUploads found;
    std::error_code error;
    for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        const fs::path& file = entry->path();
        const std::string of = file.parent_path().filename().string();
        std::uint32_t user = 0;
        const auto read = std::from_chars(of.data(), of.data() + of.size(), user);
        if (file.extension() != ".part" || read.ec != std::errc()) continue;
        std::error_code gone;  // Expected: what is gone meanwhile takes nothing
        const auto touched = fs::last_write_time(file, gone);
        const auto bytes = gone ? 0 : fs::file_size(file, gone);
        if (gone) continue;
        if (fs::file_time_type::clock::now() - touched > kAbandoned)
            fs::remove(file, gone);
        else
            found.begin(user, file.stem().string(), bytes);
    }
    return found;
}

void UnfinishedUploads::begin(std::uint32_t user, const std::string& sha256, std::uint64_t length) {
    bytes_[user][sha256] = length;
}

void UnfinishedUploads::end(std::uint32_t user, const std::string& sha256) {
    if (const auto of_user = bytes_.find(user); of_user != bytes_.end())
        of_user->second.erase(sha256);
}

std::uint64_t UnfinishedUploads::bytes_beside(std::uint32_t user, const std::string& sha256) const {
    std::uint64_t sum = 0;
    const auto of_user = bytes_.find(user);
    if (of_user == bytes_.end()) return sum;
    for (const auto& [other, bytes] : of_user->second) {
        if (other != sha256) sum += bytes;
    }
    return sum;
}

}  // namespace psfm
