// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "graph/result.h"
#include "stages/features/photographs/photo_file.h"
#include "stages/features/photographs/unread_files.h"

namespace psfm {

/// Something in the folder that cannot take part, though it looks as if it was meant to.
struct RejectedPath {
    std::string name;    ///< relative to the folder; one printable line (other bytes as \xNN)
    std::string reason;  ///< what is wrong and what to do, one line without the name
};

struct PhotoListing {
    std::vector<PhotoFile> photos;       ///< ascending by the bytes of their names
    std::vector<RejectedPath> rejected;  ///< likewise
    UnreadFiles unread;                  ///< look like photographs or videos, and are not read
};

/// Whether a file name has the extension of a photograph, in any case: jpg jpeg jpe jfif mpo png
/// tif tiff webp bmp heic heif hif avif jp2 pgm ppm pnm. Of the pictures in an MPO file the first
/// one is read.
bool has_photo_extension(std::string_view name);

/// Photographs in a folder and the folders below it. Names that begin with a dot and files that
/// are no pictures are passed over in silence; raw photographs, videos and pictures of formats that
/// are not read are counted. Links to files are followed wherever they lead (a folder of
/// links is a usual way to make a selection); links to folders are rejected, not followed, so that
/// the walk stays inside the folder and ends. Names that are no UTF-8 or hold control characters
/// are rejected, as are links that lead nowhere, pipes and devices named as photographs, and
/// sub-folders that cannot be opened.
/// @errors kNotFound: no such folder, not a folder, not readable, or no photograph in it; with the
/// remedy Thread-safe.
Result<PhotoListing> list_photos(const std::filesystem::path& folder);

}  // namespace psfm
