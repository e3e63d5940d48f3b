// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "graph/result.h"
#include "storage/exchange/files/locked_folder.h"
#include "storage/exchange/files/staged_files.h"

namespace psfm {

/// Which files of an output folder psfm wrote: kept in the folder itself, in a file named
/// `.psfm-export`, one relative path a line. Only these may be replaced or removed by a later
/// export. Nobody else exports into the folder while the object lives.
class PreviousExport {
  public:
    /// Makes the folder if need be. An absent list is an empty one.
    /// @errors kUnreadable, and those of LockedFolder
    static Result<PreviousExport> take(const std::filesystem::path& folder);

    /// Relative to the folder, '/' between parts.
    const std::set<std::string>& paths() const { return paths_; }
    bool wrote(const std::filesystem::path& path) const;
    void add(const std::filesystem::path& path);
    void remove(const std::filesystem::path& path);
    /// Stages the list. @errors kNoSpace, kIo
    Result<void> stage(StagedFiles& files) const;

  private:
    std::string relative(const std::filesystem::path& path) const;

    LockedFolder lock_;
    std::filesystem::path folder_;
    std::set<std::string> paths_;
};

}  // namespace psfm
