// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/session_place.h"

#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>

#include "tools/commands/session/session_runner.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kImporting = ".importing-";  // Format: between folder and process

/// Removes what imports into this place have left that were killed.
void remove_abandoned(const fs::path& place) {
    const std::string begins = place.filename().string() + std::string(kImporting);
    std::error_code failure;
    for (fs::directory_iterator entry(place.parent_path(), failure), end; !failure && entry != end;
         entry.increment(failure)) {
        const std::string name = entry->path().filename().string();
        if (!name.starts_with(begins)) continue;
        pid_t process = 0;
        const char* last = name.data() + name.size();
        const auto read = std::from_chars(name.data() + begins.size(), last, process);
        const bool is_ours = read.ec == std::errc() && read.ptr == last && process > 0;
        std::error_code ignored;
        if (is_ours && kill(process, 0) != 0 && errno == ESRCH)
            fs::remove_all(entry->path(), ignored);
    }
}

/// The path without links, and without a slash at its end.
fs::path without_links(const std::string& session, std::error_code& failure) {
    const fs::path absolute = fs::absolute(session, failure);
    if (failure) return {};
    fs::path place = fs::weakly_canonical(absolute, failure).lexically_normal();
    return place.has_filename() ? place : place.parent_path();
}

Error unfit(const std::string& session, const std::string& why) {
    return {ErrorCode::kInvalidArgument, session + " " + why};
}

}  // namespace

SessionPlace::SessionPlace(fs::path place)
    : place_(std::move(place)),
      beside_(place_.string() + std::string(kImporting) + std::to_string(getpid())) {}

Result<SessionPlace> SessionPlace::find(const std::string& session) {
    std::error_code failure;
    const fs::path path = without_links(session, failure);
    if (failure) {
        return Error{ErrorCode::kIo, session + " cannot be looked at: " + failure.message() +
                                         "; choose another session folder"};
    }
    SessionPlace place(path);
    const auto status = fs::symlink_status(path, failure);
    if (fs::is_symlink(status))
        return unfit(session, "is a link that leads nowhere; make the folder, or remove the link");
    if (fs::exists(status) && !fs::is_directory(status))
        return unfit(session, "is not a folder; choose another session folder");
    // The folder is replaced: the program, and the shell that has called it, would be nowhere.
    const bool is_here = fs::equivalent(path, ".", failure);
    if (is_here && !failure && !place.is_taken()) {
        return unfit(
            session,
            "is the folder that psfm runs in: name a new one in it, or run psfm elsewhere");
    }
    remove_abandoned(path);
    return place;
}

bool SessionPlace::is_taken() const {
    std::error_code failure;
    return fs::exists(place_, failure) && !fs::is_empty(place_, failure);
}

Result<void> SessionPlace::move_there() const {
    std::error_code failure;
    fs::rename(beside_, place_, failure);  // onto an empty folder, too
    if (!failure) return {};
    abandon();
    if (is_taken()) {
        return Error{ErrorCode::kInUse, place_.string() +
                                            " has been made by another program meanwhile: go on "
                                            "with it, " +
                                            command_line("resume", place_) +
                                            ", or choose another session folder"};
    }
    return Error{ErrorCode::kIo, place_.string() + " cannot be made: " + failure.message() +
                                     "; choose another session folder"};
}

void SessionPlace::abandon() const {
    std::error_code ignored;
    fs::remove_all(beside_, ignored);
}

}  // namespace psfm
