// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scheduler/flow/run_session.h"
#include "scheduler/session/session_config.h"
#include "storage/session/session_store.h"

namespace psfm {

/// What `run` and `resume` have in common.
struct RunRequest {
    std::filesystem::path session;
    std::filesystem::path input;  ///< folder of photographs, or the COLMAP database
    SessionConfig config;
    ExecutionOptions execution;
    std::string log_file;           ///< empty: no log
    bool watch = false;             ///< `input` is looked at again and again
    std::vector<PhotoFile> photos;  ///< else: what takes part, in order of arrival
    std::vector<SourcedImage>
        moved;           ///< images whose files are elsewhere by now, stored before anything
    std::string unread;  ///< describe_briefly() of the folder's other files
    std::optional<SessionSettings> settings;  ///< stored before anything else
    Salvage* salvage = nullptr;               ///< what is taken over from a damaged session
    std::string go_on_command;                ///< what goes on after a Ctrl-C
    bool may_place_none = false;  ///< the command is done all the same; it is told still
};

/// How this process works on a session whose store it opens so: keypoints of clusters that rest
/// have an eighth of the store's cache, and so have their points; a vocabulary that the user has
/// installed is used.
ExecutionOptions execution_of(int threads, const StoreOptions& store);

struct FoundPhotos {
    std::vector<PhotoFile> photos;  ///< ascending by name
    std::string unread;             ///< see RunRequest; and paths that cannot be used
};
/// What could take part: the folder's photographs, or the database's images. Tells of files that
/// cannot.
Result<FoundPhotos> photos_by_name(const RunRequest& request);

/// Brings what was found in line with what the session has: takes masks out, follows files that
/// were moved or renamed, puts small copies last, and tells of all that. Changes request.photos and
/// request.moved, not the session. Nothing happens to a session that was imported.
/// @param names_masks  the folder of masks was named by this command
/// @errors kNotFound (folder of masks), those of the store
Result<void> compare_photos(RunRequest& request, const SessionReader& store, bool names_masks);

/// What a stored session's images come from: its folder, or the database.
std::filesystem::path input_of(const SessionSettings& settings, const SessionConfig& config);

/// Names of all photographs that a session has looked at, accepted or not.
Result<std::set<std::string>> known_names(const SessionReader& store);

/// `psfm COMMAND --session DIR`, to be copied into a shell.
std::string command_line(const std::string& command, const std::filesystem::path& session);

/// Runs a session in an open store, up to the summary on stdout; Ctrl-C stops it in order. What is
/// wrong with the log or the folder is found before the session's settings are changed.
/// @return the program's exit code; failures have been reported
int run_and_report(SessionStore& store, const RunRequest& request);

}  // namespace psfm
