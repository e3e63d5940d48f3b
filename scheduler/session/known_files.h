// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "scheduler/session/file_stamp.h"
#include "stages/features/photographs/photo_file.h"
#include "storage/session/session_store.h"

namespace psfm {

/// What a folder's photographs are to a session that has some already.
struct KnownFiles {
    /// What may be new, or is where the session has it, in the order given. Another photograph
    /// under the name of one of the session's has a name of its own here, with its folder's.
    std::vector<PhotoFile> photos;
    /// Images whose files were moved or renamed, or whose files are known better now: with their
    /// new names and files, to be stored (SessionStore::commit_files). Names stay unique.
    std::vector<SourcedImage> moved;
    std::vector<std::string> told;  ///< one line for people each
};

/// Tells by their content which of a folder's photographs the session has. A file is read only
/// where its name, size or time say that it could be another one than it was; those of sessions of
/// earlier programs, which know neither, are read once.
///   - A file that was moved or renamed: its image's name follows, unless the old file is still
///     there (then it is a copy, and the session says so).
///   - Another photograph under the name of an image whose own file is there, in another folder (a
///     second memory card): taken in under `FOLDER/NAME`.
///   - Another content in the very file of an image, or where that is gone (edited, or
///   overwritten):
///     told, every time, and not among `photos`.
/// @param images  of the session by id, with where they come from beside them
/// @param photos  of `folder`, with the names that they have there
/// @param previous_folder  of the session; where the files of images are that do not say so
KnownFiles compare_with_session(std::span<const Image> images, std::span<const ImageSource> sources,
                                std::span<const PhotoFile> photos,
                                const std::filesystem::path& folder,
                                const std::filesystem::path& previous_folder);

/// Where a photograph lies, for ImageFile: its path without its name; empty when the path does not
/// end with that (the images of a database).
std::string folder_of(const PhotoFile& photo);

/// The same with its stamp; nothing is known of files that are not in a folder of photographs.
ImageFile file_of(const PhotoFile& photo, const FileStamp& stamp);

}  // namespace psfm
