// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/staged_files.h"

#include <algorithm>

namespace psfm {

StagedFiles::~StagedFiles() {
    std::error_code ignored;
    for (const Staged& file : staged_) std::filesystem::remove(file.temporary, ignored);
    // The last one made first. Only empty ones go: removal of others fails.
    for (; !made_folders_.empty(); made_folders_.pop_back()) {
        std::filesystem::remove(made_folders_.back(), ignored);
    }
}

Result<void> StagedFiles::make_folder(const std::filesystem::path& folder) {
    if (folder.empty() || std::filesystem::is_directory(folder)) return {};
    if (auto made = make_folder(folder.parent_path()); !made) return made;
    std::error_code failure;
    std::filesystem::create_directory(folder, failure);
    if (failure) return file_error(folder, failure.value());
    made_folders_.push_back(folder);
    return {};
}

Result<void> StagedFiles::write(const std::filesystem::path& path,
                                const std::function<void(OutputFile&)>& contents) {
    if (auto made = make_folder(path.parent_path()); !made) return made;
    const std::filesystem::path temporary = path.string() + ".partial";
    staged_.push_back({temporary, path});
    OutputFile file(temporary);
    contents(file);
    return file.close();
}

void StagedFiles::remove_outdated(const std::filesystem::path& path) {
    outdated_.push_back(path);
}

Result<void> StagedFiles::commit() {
    std::error_code failure;
    for (const Staged& file : staged_) {
        std::filesystem::rename(file.temporary, file.path, failure);
        if (failure) return file_error(file.path, failure.value());
    }
    std::error_code ignored;
    for (const auto& path : outdated_) {
        const bool written = std::ranges::find(staged_, path, &Staged::path) != staged_.end();
        if (written) continue;
        if (!std::filesystem::remove(path, failure) && failure) {
            return file_error(path, failure.value());
        }
        const auto folder = path.parent_path();
        if (std::filesystem::is_empty(folder, ignored)) std::filesystem::remove(folder, ignored);
    }
    staged_.clear();
    made_folders_.clear();
    return {};
}

}  // namespace psfm
