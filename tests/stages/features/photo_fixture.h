// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stages/features/photographs/photo_file.h"

namespace Exiv2 {
class ExifData;
}

namespace psfm::testing {

using Bytes = std::vector<std::uint8_t>;

/// A folder of its own, removed with all it holds at the end.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Writes a file, with the folders that it needs.
    PhotoFile write(std::string_view name, std::span<const std::uint8_t> bytes) const;
    PhotoFile write(std::string_view name, std::string_view text) const;

  private:
    std::filesystem::path path_;
};

/// BGR noise, blurred so that SIFT finds features everywhere; equal for equal seeds.
cv::Mat textured_image(int width, int height, std::uint64_t seed = 1);

/// cv::imencode; extension with its dot.
Bytes encode(const cv::Mat& image, const std::string& extension);

/// The bytes of a JPEG, PNG, WebP, TIFF or JPEG 2000 file with EXIF data added by exiv2.
Bytes with_exif(const Bytes& bytes, const Exiv2::ExifData& exif);

}  // namespace psfm::testing
