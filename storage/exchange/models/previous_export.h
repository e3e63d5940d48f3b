// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "graph/result.h"
#include "storage/exchange/files/locked_folder.h"
#include "storage/exchange/files/staged_files.h"

namespace psfm {

/// What psfm wrote into an output folder: kept in the folder itself, in a file named
/// `.psfm-export`, one relative path a line. An export claims what it will write and settles: what
/// psfm wrote there before, in whatever format, is replaced or goes; nothing of anybody else is
/// replaced, removed, or reached through a symbolic link. Nobody else exports into the folder while
/// the object lives.
class PreviousExport {
  public:
    /// Makes the folder if need be. An absent list is an empty one. What an export that was killed
    /// had not put into its place yet is removed.
    /// @errors kUnreadable, and those of LockedFolder
    static Result<PreviousExport> take(const std::filesystem::path& folder);

    /// Relative to the folder, '/' between parts.
    const std::set<std::string>& paths() const { return paths_; }
    bool wrote(const std::filesystem::path& path) const;

    /// This export writes the file, or link.
    /// @errors kInvalidArgument: what is there, or in a folder of its name, or a folder or link on
    ///         the way, is somebody else's; with its path and what to do
    Result<void> claim(const std::filesystem::path& path);
    /// The same of a folder for others to write into, which may be there.
    Result<void> claim_folder(const std::filesystem::path& path);
    /// Takes back what was claimed within a folder, or of one file.
    void give_up(const std::filesystem::path& path);
    /// What was written there before stays.
    void keep(const std::filesystem::path& folder);
    /// What was written before and is neither claimed nor kept. Descending: in a folder models go
    /// before the pictures that they name.
    std::vector<std::filesystem::path> outdated() const;

    /// Names in the list what is claimed, beside what is there: should the machine stop between two
    /// files, none is a stranger. @errors kNoSpace, kIo
    Result<void> announce() const;
    /// announce(), commits the files, removes what is outdated, and writes the list.
    /// @errors those of StagedFiles::commit(), kNoSpace, kIo
    Result<void> settle(StagedFiles& files);

  private:
    std::string relative(const std::filesystem::path& path) const;
    Result<void> check_way(const std::filesystem::path& path) const;
    Result<void> write_list(const std::set<std::string>& paths) const;

    LockedFolder lock_;
    std::filesystem::path folder_;
    std::set<std::string> paths_;
    std::set<std::string> claimed_;
    std::vector<std::filesystem::path> kept_;
};

/// The error for something in the way.
Error not_written_by_psfm(const std::filesystem::path& path);

}  // namespace psfm
