// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/output_folder.h"

#include <algorithm>

#include "scheduler/session/photo_folders.h"
#include "storage/exchange/files/locked_folder.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

/// One spelling of a path, links followed as far as they are there.
fs::path resolved(const fs::path& path) {
    std::error_code error;
    const fs::path absolute = fs::absolute(path, error);
    const fs::path canonical = fs::weakly_canonical(absolute, error);
    const fs::path normal = error ? absolute.lexically_normal() : canonical;
    return normal.has_filename() ? normal : normal.parent_path();  // without a '/' at the end
}

bool lies_in(const fs::path& path, const fs::path& folder) {
    return std::ranges::mismatch(folder, path).in1 == folder.end();
}

}  // namespace

Result<void> check_output_folder(const fs::path& output, const fs::path& session) {
    if (output.empty())
        return Error{ErrorCode::kInvalidArgument, "the output folder has no name: give one"};
    if (auto possible = LockedFolder::check(output); !possible.ok()) return possible.error();
    const fs::path folder = resolved(output);
    const fs::path kept = resolved(session);
    if (!lies_in(folder, kept)) return {};
    return Error{ErrorCode::kInvalidArgument,
                 output.string() + " is the session " + session.string() +
                     " or within it, where only its own files are: choose another output folder"};
}

Result<void> check_apart_from_photographs(const fs::path& output, const fs::path& photo_folder,
                                          std::span<const Image> images) {
    const fs::path folder = resolved(output);
    const fs::path photos = resolved(photo_folder);
    if (photo_folder.empty() || !lies_in(folder, photos)) return {};
    const std::string below = folder.lexically_relative(photos).generic_string() + '/';
    const bool has_some = folder == photos || std::ranges::any_of(images, [&](const Image& image) {
                              return image.name.starts_with(below);
                          });
    if (!has_some) return {};
    return Error{ErrorCode::kInvalidArgument,
                 output.string() +
                     " has the photographs, and the next `psfm run` could not tell them from what "
                     "is written there: choose another output folder"};
}

Result<void> check_apart_from_photographs(const fs::path& output, const SessionReader& reader,
                                          const fs::path& session) {
    const auto folders = photo_folders(reader, session);
    if (!folders.ok()) return folders.error();
    const auto images = reader.images();
    if (!images.ok()) return images.error();
    for (const fs::path& folder : *folders) {
        auto apart = check_apart_from_photographs(output, folder, *images);
        if (!apart.ok()) return apart.error();
    }
    return {};
}

}  // namespace psfm
