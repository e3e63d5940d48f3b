// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/files/staged_files.h"

#include <algorithm>
#include <array>
#include <fstream>

namespace psfm {
namespace {

bool have_equal_bytes(const std::filesystem::path& one, const std::filesystem::path& other) {
    std::error_code failure;
    if (!std::filesystem::is_regular_file(other, failure)) return false;
    const auto size = std::filesystem::file_size(one, failure);
    if (failure || size != std::filesystem::file_size(other, failure) || failure) return false;
    std::ifstream first(one, std::ios::binary);
    std::ifstream second(other, std::ios::binary);
    std::array<char, 1 << 16> a{};
    std::array<char, 1 << 16> b{};
    while (first && second) {
        first.read(a.data(), a.size());
        second.read(b.data(), b.size());
        if (first.gcount() != second.gcount()) return false;
        if (!std::equal(a.begin(), a.begin() + first.gcount(), b.begin())) return false;
    }
    return first.eof() && second.eof();
}

}  // namespace

StagedFiles::~StagedFiles() {
    std::error_code ignored;
    for (const auto& temporary : begun_) std::filesystem::remove(temporary, ignored);
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

Result<std::filesystem::path> StagedFiles::begin(const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    if (auto made = make_folder(path.parent_path()); !made.ok()) return made.error();
    return begun_.emplace_back(path.string() + ".partial");
}

void StagedFiles::stage_unless_equal(const std::filesystem::path& temporary,
                                     const std::filesystem::path& path) {
    const bool equal = have_equal_bytes(temporary, path);
    std::error_code ignored;
    if (equal) std::filesystem::remove(temporary, ignored);
    const std::lock_guard lock(mutex_);
    staged_.push_back({equal ? std::filesystem::path() : temporary, path});
}

Result<void> StagedFiles::write(const std::filesystem::path& path,
                                const std::function<void(OutputFile&)>& contents) {
    const auto temporary = begin(path);
    if (!temporary.ok()) return temporary.error();
    OutputFile file(*temporary);
    contents(file);
    if (auto closed = file.close(); !closed.ok()) return closed.error();
    stage_unless_equal(*temporary, path);
    return {};
}

Result<void> StagedFiles::link(const std::filesystem::path& of, const std::filesystem::path& path) {
    const auto temporary = begin(path);
    if (!temporary.ok()) return temporary.error();
    const auto original = std::ranges::find(staged_, of, &Staged::path);
    const std::filesystem::path& source =
        original == staged_.end() || original->temporary.empty() ? of : original->temporary;
    std::error_code failure;
    std::filesystem::remove(*temporary, failure);
    std::filesystem::create_hard_link(source, *temporary, failure);
    if (failure) std::filesystem::copy_file(source, *temporary, failure);
    if (failure) return file_error(path, failure.value());
    stage_unless_equal(*temporary, path);
    return {};
}

Result<void> StagedFiles::link_folder(const std::filesystem::path& target,
                                      const std::filesystem::path& path) {
    const auto temporary = begin(path);
    if (!temporary.ok()) return temporary.error();
    std::error_code failure;
    if (std::filesystem::read_symlink(path, failure) == target) {
        staged_.push_back({{}, path});
        return {};
    }
    std::filesystem::remove(*temporary, failure);
    std::filesystem::create_directory_symlink(target, *temporary, failure);
    if (failure) return file_error(path, failure.value());
    staged_.push_back({*temporary, path});
    return {};
}

Result<void> StagedFiles::folder(const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    return make_folder(path);
}

void StagedFiles::remove_outdated(const std::filesystem::path& path) {
    outdated_.push_back(path);
}

Result<void> StagedFiles::commit() {
    std::error_code failure;
    for (const Staged& file : staged_) {
        if (file.temporary.empty()) continue;
        std::filesystem::rename(file.temporary, file.path, failure);
        if (failure) return file_error(file.path, failure.value());
    }
    std::error_code ignored;
    for (const auto& path : outdated_) {
        const bool written = std::ranges::find(staged_, path, &Staged::path) != staged_.end();
        if (written) continue;
        std::filesystem::remove(path, failure);
        if (failure && failure != std::errc::directory_not_empty) {
            return file_error(path, failure.value());
        }
        auto folder = path.parent_path();
        while (std::filesystem::is_empty(folder, ignored) &&
               std::filesystem::remove(folder, ignored)) {
            folder = folder.parent_path();
        }
    }
    staged_.clear();
    begun_.clear();
    made_folders_.clear();
    return {};
}

}  // namespace psfm
