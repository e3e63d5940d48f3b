// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/result.h"
#include "stages/features/photographs/photo_file.h"

namespace psfm {

/// The names, without a folder, that a mask of a photograph may have, as those of COLMAP, Metashape
/// and others do: of a.jpg a.jpg.png, a_mask.png and a.png, likewise with other extensions of
/// pictures; the first that is there counts.
std::vector<std::string> mask_names(std::string_view photo_name);

/// The mask of a photograph in a folder of masks, in the sub-folder that the photograph has in its
/// own; nothing when there is none. Asks the file system. Thread-safe.
std::optional<std::filesystem::path> find_mask(const std::filesystem::path& masks,
                                               const PhotoFile& photo);

struct PhotoMask {
    cv::Mat visible;         ///< 8-bit, 0 under the mask, 255 elsewhere; of the asked size
    std::uint64_t hash = 0;  ///< xxHash64 of the file
};

/// Reads a mask: what is darker than half of its brightest pixel is hidden, so that masks of 0 and
/// 1, of 0 and 255, and those with soft edges or compressed as JPEG all mean what they show. One
/// that is of another size is brought to that of the photograph where its proportions are the same;
/// where they are those of the photograph turned upright, it is turned back.
/// @param size  of the photograph, on its stored grid
/// @param orientation  EXIF's, of the photograph
/// @errors kIo, kUnreadable: one line that names the mask and the remedy
/// Thread-safe.
Result<PhotoMask> read_mask(const std::filesystem::path& file, cv::Size size,
                            std::uint8_t orientation);

/// What of a photograph is at least half transparent, as a mask; empty when nothing is.
/// @param alpha  8-bit or 16-bit, one channel
cv::Mat mask_from_alpha(const cv::Mat& alpha);

}  // namespace psfm
