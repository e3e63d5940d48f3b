// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/session_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>

#include "storage/database/system_error.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
constexpr const char* kMarkerTemporary = "psfm-session.tmp";
constexpr const char* kMarkerFirstLine = "psfm session";
constexpr std::string_view kFormatWord = "format ";

Error something_else(const fs::path& folder) {
    return {ErrorCode::kInvalidArgument,
            quoted(folder) + " is not a psfm session; choose an empty or new folder"};
}

Result<FolderState> read_marker(const fs::path& folder) {
    const fs::path path = folder / kMarkerFile;
    std::ifstream file(path);
    if (!file) return system_error("cannot read " + quoted(path), errno);
    std::string first;
    std::string second;
    std::getline(file, first);
    std::getline(file, second);
    int format = 0;
    const bool has_word = second.starts_with(kFormatWord);
    const char* const end = second.data() + second.size();
    const bool has_number =
        has_word && std::from_chars(second.data() + kFormatWord.size(), end, format).ptr == end;
    if (first != kMarkerFirstLine || !has_number || format < 1) {
        return Error{ErrorCode::kDamaged, quoted(path) + " is damaged; it should read '" +
                                              kMarkerFirstLine + "' and 'format 1'"};
    }
    if (format > kSessionFormat) {
        return Error{ErrorCode::kVersion, session_label(folder) + " has format " +
                                              std::to_string(format) +
                                              ", written by a newer psfm; use that version"};
    }
    return FolderState::kSession;
}

bool is_of_the_store(const std::string& name) {
    constexpr std::array<std::string_view, 6> kNames{kMarkerFile,    kMarkerTemporary,
                                                     kLockFile,      kDatabaseFolder,
                                                     kReadersFolder, kReplacedDatabaseFolder};
    return std::ranges::find(kNames, name) != kNames.end();
}

bool is_our_lock(const fs::path& path) {
    std::ifstream file(path);
    std::string first;
    std::getline(file, first);
    return first == kLockFirstLine;
}

/// A file's contents on disk for good, under a name that is there whole or not at all.
Result<void> write_synced(const fs::path& folder, const char* temporary, const char* name,
                          const std::string& text) {
    const fs::path from = folder / temporary;
    const fs::path to = folder / name;
    const auto failed = [&] { return system_error("cannot write " + quoted(to), errno); };
    const int file = ::open(from.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (file < 0) return failed();
    const bool written =
        ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
        ::fsync(file) == 0;
    const int error_number = errno;
    ::close(file);
    if (!written) return system_error("cannot write " + quoted(to), error_number);
    if (::rename(from.c_str(), to.c_str()) != 0) return failed();
    const int directory = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory < 0) return failed();
    const int synced = ::fsync(directory);
    const int sync_error = errno;
    ::close(directory);
    if (synced != 0) return system_error("cannot write " + quoted(to), sync_error);
    return {};
}

}  // namespace

Result<FolderState> inspect_session_folder(const fs::path& folder) {
    std::error_code error;
    const fs::file_status status = fs::status(folder, error);
    if (status.type() == fs::file_type::not_found) return FolderState::kNew;
    if (error) return system_error("cannot look at " + quoted(folder), error.value());
    if (status.type() != fs::file_type::directory) return something_else(folder);
    if (fs::exists(folder / kMarkerFile, error)) return read_marker(folder);

    bool empty = true;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        empty = false;
        if (!is_of_the_store(entry->path().filename().string())) return something_else(folder);
    }
    if (error) return system_error("cannot look into " + quoted(folder), error.value());
    // Only folders whose lock file we wrote are ours to finish.
    if (!empty && !is_our_lock(folder / kLockFile)) return something_else(folder);
    return FolderState::kNew;
}

std::vector<std::string> entries_of_others(const fs::path& session) {
    std::vector<std::string> names;
    std::error_code error;
    for (fs::directory_iterator entry(session, error), end; !error && entry != end;
         entry.increment(error)) {
        std::string name = entry->path().filename().string();
        if (!is_of_the_store(name)) names.push_back(std::move(name));
    }
    std::ranges::sort(names);
    return names;
}

Result<void> write_session_marker(const fs::path& folder) {
    const std::string text = std::string(kMarkerFirstLine) + "\n" + std::string(kFormatWord) +
                             std::to_string(kSessionFormat) + "\n";
    return write_synced(folder, kMarkerTemporary, kMarkerFile, text);
}

std::string quoted(const fs::path& path) {
    // Appended to, not "a" + b + "c": g++ 12 warns wrongly of overlap there (-Wrestrict).
    std::string text(1, '\'');
    text.append(path.string());
    text.push_back('\'');
    return text;
}

std::string session_label(const fs::path& folder) {
    return std::string("session ").append(quoted(folder));
}

}  // namespace psfm
