// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "graph/result.h"
#include "storage/exchange/files/output_file.h"

namespace psfm {

/// Name of the folder, within the output folder, of files that have no place yet.
inline constexpr const char* kStagingFolder = ".psfm-partial";

/// Files of one folder that appear together: each is written into its folder `.psfm-partial`, and
/// only commit() puts them into their places. Until then, and after any failure before it, what was
/// there before is untouched; the destructor removes what was not committed, and folders made for
/// it. A file whose contents are those that are there already is left alone. Nothing is written or
/// removed through a symbolic link below the folder.
/// write() is thread-safe; the rest is not.
class StagedFiles {
  public:
    /// @param folder  all paths below are within it; made if need be
    explicit StagedFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
    StagedFiles(const StagedFiles&) = delete;
    StagedFiles& operator=(const StagedFiles&) = delete;
    ~StagedFiles();

    /// Writes the file.
    /// @errors kNoSpace, kIo, with the path
    Result<void> write(const std::filesystem::path& path,
                       const std::function<void(OutputFile&)>& contents);
    /// The same contents under a second name: a hard link where the file system has them.
    /// @param of  written before
    Result<void> link(const std::filesystem::path& of, const std::filesystem::path& path);
    /// A symbolic link to a folder.
    Result<void> link_folder(const std::filesystem::path& target,
                             const std::filesystem::path& path);
    /// A folder, which may stay empty; commit() makes it if need be.
    void folder(const std::filesystem::path& path) { folders_.push_back(path); }
    /// Marks an outdated file or link, or a folder that goes if it is empty, and folders above that
    /// become empty, for removal by commit().
    void remove_outdated(const std::filesystem::path& path) { outdated_.push_back(path); }

    /// Takes away what will change, the last file written first, then what is outdated, in the
    /// order of the calls; then puts all files into their places, the first one written first. So
    /// files that are read together are never old and new ones, whenever the process dies: what
    /// opens a set is to be written last.
    /// @errors kInvalidArgument (a link on the way), kIo, with the path; then some files are gone
    Result<void> commit();

  private:
    struct Staged {
        std::filesystem::path temporary;
        std::filesystem::path path;
    };

    Result<void> make_folder(const std::filesystem::path& folder);
    Result<void> take_away(const std::filesystem::path& path);
    Result<void> put(const Staged& file);
    void remove_made_folders(const std::filesystem::path& within);
    /// Makes the temporary's folder, and its name.
    Result<std::filesystem::path> begin(const std::filesystem::path& path);
    void stage_unless_equal(const std::filesystem::path& temporary,
                            const std::filesystem::path& path);

    std::filesystem::path folder_;
    std::mutex mutex_;
    std::vector<Staged> staged_;
    std::vector<std::filesystem::path> begun_;  ///< temporaries that may be there
    std::vector<std::filesystem::path> outdated_;
    std::vector<std::filesystem::path> folders_;
    std::vector<std::filesystem::path> made_folders_;  ///< outermost first
};

}  // namespace psfm
