// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "graph/result.h"
#include "graph/undistorted_view.h"
#include "stages/features/feature_options.h"
#include "stages/features/photographs/photo_file.h"

namespace psfm {

/// What pictures are written as: without metadata, so that no reader turns them a second time.
enum class PictureFormat {
    kAuto,  ///< PNG of a PNG, JPEG of anything else
    kJpeg,
    kPng,
};

struct PictureOptions {
    PictureFormat format = PictureFormat::kAuto;
    /// 1 … 100. Raised: larger files; lowered: blocks, which trainers learn. Ours: above what
    /// phones write, so that a second encoding costs little.
    int jpeg_quality = 95;
    /// Further copies, reduced by these factors (2 and more), averaged over areas.
    std::vector<std::uint32_t> reductions = {};
    /// A mask beside each picture: what a file of mask_folder hides of the photograph
    /// (find_mask()), and where it is transparent.
    bool masks = false;
    std::filesystem::path mask_folder = {};  ///< empty: none
    ReadPhotoOptions read = {};
};

/// ".jpg" or ".png". @param photo_name  of the photograph, with its extension
std::string picture_extension(std::string_view photo_name, PictureFormat format);

/// The file of a picture, and those of its reduced copies in the order of PictureOptions.
struct PictureFiles {
    std::vector<std::vector<std::uint8_t>> bytes;
    /// PNGs in the same order: 0 where nothing is to be learnt, else 255; none without
    /// options.masks.
    std::vector<std::vector<std::uint8_t>> masks = {};
};

/// Makes the picture of a photograph. Where the two are the same pixels and the file can stay as it
/// is (same format, nothing about it says to turn it), the picture is the file.
/// @param orientation  the photograph's EXIF orientation
/// @param content_hash  of the photograph that the view was estimated from; 0: not known
/// @errors kNotFound: no such file; kInvalidArgument: its content is another one; as read_photo()
///         and read_mask() else. One line that names the photograph and the remedy. No exception
///         leaves this function.
/// Deterministic. Thread-safe; peak memory about 8 bytes a pixel of the photograph.
Result<PictureFiles> undistort_photo(const PhotoFile& photo, std::uint64_t content_hash,
                                     std::uint8_t orientation, const UndistortedView& view,
                                     const PictureOptions& options);

}  // namespace psfm
