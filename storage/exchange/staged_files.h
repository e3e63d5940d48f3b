// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "graph/result.h"
#include "storage/exchange/output_file.h"

namespace psfm {

/// Files that appear together: each is written beside its place under a temporary name (".partial"
/// appended), and only commit() gives them their names. Until then, and after any failure, what was
/// there before is untouched; the destructor removes temporaries, and folders made for them, that
/// were not committed. Not thread-safe.
class StagedFiles {
  public:
    StagedFiles() = default;
    StagedFiles(const StagedFiles&) = delete;
    StagedFiles& operator=(const StagedFiles&) = delete;
    ~StagedFiles();

    /// Makes the file's folder if need be and writes the file.
    /// @errors kNoSpace, kIo, with the path
    Result<void> write(const std::filesystem::path& path,
                       const std::function<void(OutputFile&)>& contents);
    /// Marks an outdated file, and its folder if that becomes empty, for removal by commit().
    void remove_outdated(const std::filesystem::path& path);

    /// Removes what is outdated and gives all files their names.
    /// @errors kIo, with the path; then files committed before that one keep their new contents
    Result<void> commit();

  private:
    struct Staged {
        std::filesystem::path temporary;
        std::filesystem::path path;
    };

    Result<void> make_folder(const std::filesystem::path& folder);

    std::vector<Staged> staged_;
    std::vector<std::filesystem::path> outdated_;
    std::vector<std::filesystem::path> made_folders_;  ///< outermost first
};

}  // namespace psfm
