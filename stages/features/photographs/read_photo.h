// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "graph/result.h"
#include "stages/features/photographs/photo_container.h"
#include "stages/features/photographs/photo_file.h"
#include "stages/features/photographs/read_exif.h"
#include "stages/features/photographs/read_photo_options.h"

namespace psfm {

/// A decoded photograph. Invariant: colour and grey have the same size.
struct DecodedPhoto {
    cv::Mat colour;  ///< 8-bit BGR on the stored pixel grid (EXIF orientation not applied)
    cv::Mat grey;    ///< 8-bit, ITU-R BT.601 luma
    cv::Mat mask;    ///< 8-bit: 0 where the photograph is transparent; empty: nowhere
    std::uint64_t content_hash = 0;  ///< xxHash64, seed 0, of the file's bytes
    ExifTags exif;                   ///< empty when there are none
    PhotoFormat format = PhotoFormat::kJpeg;
    /// What is wrong with a file that was read all the same, for people: one line each, which names
    /// the photograph.
    std::vector<std::string> remarks = {};
};

/// Reads, checks, hashes and decodes one photograph. A JPEG that lacks only its end marker is read,
/// with a remark; one is made, too, of a position that is no place on the earth.
/// @errors kIo: cannot be read; kUnreadable: is no image, is truncated or damaged, is smaller or
///         larger than the options allow; one line that names the photograph and the remedy
/// Thread-safe.
Result<DecodedPhoto> read_photo(const PhotoFile& photo, const ReadPhotoOptions& options);

}  // namespace psfm
