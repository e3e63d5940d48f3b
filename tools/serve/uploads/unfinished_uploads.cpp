// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/uploads/unfinished_uploads.h"

#include <charconv>
#include <chrono>

#include "tools/serve/uploads/sha256.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

template <typename T>
std::optional<T> number_in(const std::string& text) {
    T number = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    if (read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
    return number;
}

}  // namespace

UnfinishedUploads UnfinishedUploads::found_in(const fs::path& folder) {
    UnfinishedUploads found;
    found.folder_ = folder;
    std::error_code error;
    for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        const fs::path& file = entry->path();
        const auto user = number_in<std::uint32_t>(file.parent_path().filename().string());
        if (file.extension() != ".part" || !user) continue;
        const fs::path named = file.stem();
        const std::string length_text = named.extension().string();
        const auto length =
            length_text.empty() ? std::nullopt : number_in<std::uint64_t>(length_text.substr(1));
        std::error_code gone;  // Expected: what is gone meanwhile takes nothing
        if (length.value_or(0) > 0 && is_sha256(named.stem().string()))
            found.begin(*user, named.stem().string(), *length);
        else
            fs::remove(file, gone);  // nobody could go on with it
    }
    found.remove_abandoned([](const std::string&) { return false; });
    return found;
}

void UnfinishedUploads::begin(std::uint32_t user, const std::string& sha256, std::uint64_t length) {
    lengths_[user][sha256] = length;
}

void UnfinishedUploads::end(std::uint32_t user, const std::string& sha256) {
    if (const auto of_user = lengths_.find(user); of_user != lengths_.end())
        of_user->second.erase(sha256);
}

std::optional<std::uint64_t> UnfinishedUploads::length_of(std::uint32_t user,
                                                          const std::string& sha256) const {
    const auto of_user = lengths_.find(user);
    if (of_user == lengths_.end()) return std::nullopt;
    const auto one = of_user->second.find(sha256);
    return one == of_user->second.end() ? std::nullopt : std::optional(one->second);
}

std::uint64_t UnfinishedUploads::bytes_beside(std::uint32_t user, const std::string& sha256) const {
    std::uint64_t sum = 0;
    const auto of_user = lengths_.find(user);
    if (of_user == lengths_.end()) return sum;
    for (const auto& [other, bytes] : of_user->second) {
        if (other != sha256) sum += bytes;
    }
    return sum;
}

fs::path UnfinishedUploads::part_of(std::uint32_t user, const std::string& sha256) const {
    const std::uint64_t length = length_of(user, sha256).value_or(0);
    return folder_ / std::to_string(user) / (sha256 + '.' + std::to_string(length) + ".part");
}

bool UnfinishedUploads::remove_if_abandoned(const fs::path& part) {
    constexpr auto kAbandoned = std::chrono::hours(24);  // Guard: phones go on within a day
    std::error_code error;
    const auto touched = fs::last_write_time(part, error);
    if (error) return true;  // Expected: it is gone
    if (fs::file_time_type::clock::now() - touched <= kAbandoned) return false;
    fs::remove(part, error);
    return !error;
}

}  // namespace psfm
