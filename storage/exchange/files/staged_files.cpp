// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/files/staged_files.h"

#include <algorithm>
#include <array>
#include <fstream>

#include "storage/exchange/files/link_on_the_way.h"

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
    remove_made_folders({});
}

/// The last one made first. Only empty ones go: removal of others fails.
void StagedFiles::remove_made_folders(const std::filesystem::path& within) {
    std::error_code ignored;
    std::for_each(made_folders_.rbegin(), made_folders_.rend(), [&](const auto& folder) {
        if (std::ranges::mismatch(within, folder).in1 == within.end())
            std::filesystem::remove(folder, ignored);
    });
}

Result<void> StagedFiles::make_folder(const std::filesystem::path& folder) {
    std::error_code failure;
    if (folder.empty() || std::filesystem::is_directory(folder, failure)) return {};
    if (auto made = make_folder(folder.parent_path()); !made) return made;
    if (std::filesystem::create_directory(folder, failure)) made_folders_.push_back(folder);
    if (failure) return file_error(folder, failure.value());
    return {};
}

Result<std::filesystem::path> StagedFiles::begin(const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    const auto temporary = folder_ / kStagingFolder / path.lexically_relative(folder_);
    if (auto made = make_folder(temporary.parent_path()); !made.ok()) return made.error();
    return begun_.emplace_back(temporary);
}

void StagedFiles::stage_unless_equal(const std::filesystem::path& temporary,
                                     const std::filesystem::path& path) {
    const bool equal = !link_on_the_way(folder_, path) && have_equal_bytes(temporary, path);
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
    if (!link_on_the_way(folder_, path) && std::filesystem::read_symlink(path, failure) == target) {
        staged_.push_back({{}, path});
        return {};
    }
    std::filesystem::remove(*temporary, failure);
    std::filesystem::create_directory_symlink(target, *temporary, failure);
    if (failure) return file_error(path, failure.value());
    staged_.push_back({*temporary, path});
    return {};
}

/// A file, a link, or a folder that is empty; then the folders above it that are empty, too.
Result<void> StagedFiles::take_away(const std::filesystem::path& path) {
    std::error_code failure;
    if (link_on_the_way(folder_, path)) return {};  // what is there is not what was written
    if (!std::filesystem::exists(std::filesystem::symlink_status(path, failure))) return {};
    std::filesystem::remove(path, failure);
    if (failure == std::errc::directory_not_empty) return {};
    if (failure) return file_error(path, failure.value());
    for (auto above = path.lexically_relative(folder_).parent_path(); !above.empty();
         above = above.parent_path()) {
        if (!std::filesystem::is_empty(folder_ / above, failure) ||
            !std::filesystem::remove(folder_ / above, failure))
            break;
    }
    return {};
}

Result<void> StagedFiles::put(const Staged& file) {
    if (const auto link = link_on_the_way(folder_, file.path)) {
        return Error{ErrorCode::kInvalidArgument,
                     link->string() +
                         " is a link, and nothing is written through links: choose "
                         "another output folder, or remove the link"};
    }
    if (auto made = make_folder(file.path.parent_path()); !made.ok()) return made.error();
    std::error_code failure;
    std::filesystem::rename(file.temporary, file.path, failure);
    if (failure) return file_error(file.path, failure.value());
    return {};
}

Result<void> StagedFiles::commit() {
    std::vector<Staged> changed;
    for (const Staged& file : staged_) {
        if (!file.temporary.empty()) changed.push_back(file);
    }
    // The first one takes the old one's place in one step: all others are gone by then.
    for (std::size_t n = changed.size(); n-- > 1;) {
        if (auto gone = take_away(changed[n].path); !gone.ok()) return gone.error();
    }
    for (const auto& path : outdated_) {
        if (std::ranges::find(staged_, path, &Staged::path) != staged_.end()) continue;
        if (auto gone = take_away(path); !gone.ok()) return gone.error();
    }
    for (const Staged& file : changed) {
        if (auto done = put(file); !done.ok()) return done.error();
    }
    for (const auto& path : folders_) {
        if (auto made = make_folder(path); !made.ok()) return made.error();
    }
    remove_made_folders(folder_ / kStagingFolder);
    staged_.clear();
    begun_.clear();
    made_folders_.clear();
    return {};
}

}  // namespace psfm
