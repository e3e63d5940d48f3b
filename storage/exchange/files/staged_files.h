// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <vector>

#include "graph/result.h"
#include "storage/exchange/files/output_file.h"

namespace psfm {

/// Files that appear together: each is written beside its place under a temporary name (".partial"
/// appended), and only commit() gives them their names. Until then, and after any failure, what was
/// there before is untouched; the destructor removes temporaries, and folders made for them, that
/// were not committed. A file whose contents are those that are there already is left alone.
/// write() is thread-safe; the rest is not.
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
    /// The same contents under a second name: a hard link where the file system has them.
    /// @param of  written before
    Result<void> link(const std::filesystem::path& of, const std::filesystem::path& path);
    /// A symbolic link to a folder.
    Result<void> link_folder(const std::filesystem::path& target,
                             const std::filesystem::path& path);
    /// Makes a folder if need be; commit() leaves it, also when it is empty.
    Result<void> folder(const std::filesystem::path& path);
    /// Marks an outdated file, or a folder that goes if it is empty, and folders above that become
    /// empty, for removal by commit().
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
    /// Makes the file's folder, and its temporary's name.
    Result<std::filesystem::path> begin(const std::filesystem::path& path);
    void stage_unless_equal(const std::filesystem::path& temporary,
                            const std::filesystem::path& path);

    std::mutex mutex_;
    std::vector<Staged> staged_;
    std::vector<std::filesystem::path> begun_;  ///< temporaries that may be there
    std::vector<std::filesystem::path> outdated_;
    std::vector<std::filesystem::path> made_folders_;  ///< outermost first
};

}  // namespace psfm
