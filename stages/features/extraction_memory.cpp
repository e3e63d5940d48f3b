// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/extraction_memory.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>
#include <vector>

#include "graph/image.h"

namespace psfm {
namespace {

/// Guard: what holds the size of all but unusual files: EXIF data with their thumbnail are in front
/// of it.
constexpr std::size_t kHeaderBytes = std::size_t{256} << 10U;
/// Guard: pixels of a photograph whose header does not tell, for each byte of the file: HEIF and
/// JPEG at their strongest usual compression.
constexpr double kPixelsPerByte = 8.0;
/// Guard: colour, and a copy while it is converted: from 16 bits, or to grey.
constexpr double kBytesPerPixel = 9.0;
/// Guard: of the image that features are detected in: grey, its mask, and the coarser octaves (a
/// float for each fourth pixel, sixteenth …).
constexpr double kBytesPerReducedPixel = 4.0;
/// Guard: places and features while they are chosen from.
constexpr std::size_t kBytesPerFeature = 1024;

std::optional<PhotoSize> size_in_header(const std::filesystem::path& path) {
    std::vector<std::uint8_t> bytes(kHeaderBytes);
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    const auto format = identify_format(bytes);
    if (!format) return std::nullopt;
    return parse_container(*format, bytes).size;
}

}  // namespace

std::size_t extraction_bytes(const PhotoSize& size, std::uint64_t file_bytes,
                             const FeatureOptions& options) {
    const auto longer = static_cast<double>(std::max<std::uint64_t>({size.width, size.height, 1}));
    const double pixels = static_cast<double>(size.width) * static_cast<double>(size.height);
    const double reduction = std::min(1.0, options.sift.max_image_size / longer);
    const double bytes = static_cast<double>(file_bytes) + kBytesPerPixel * pixels +
                         kBytesPerReducedPixel * pixels * reduction * reduction;
    return static_cast<std::size_t>(bytes) + (std::size_t{options.sift.strip_mib} << 20U) +
           kBytesPerFeature * options.sift.max_features;
}

std::size_t extraction_bytes(const PhotoFile& photo, const FeatureOptions& options) {
    std::error_code error;
    // Pipes and devices must not be opened.
    if (!std::filesystem::is_regular_file(photo.path, error)) return 0;
    const auto file_bytes = std::filesystem::file_size(photo.path, error);
    if (error) return 0;
    if (const auto size = size_in_header(photo.path))
        return extraction_bytes(*size, file_bytes, options);
    const double most = options.read.max_megapixels * 1e6;
    const double pixels = std::min(most, kPixelsPerByte * static_cast<double>(file_bytes));
    return extraction_bytes({static_cast<std::uint64_t>(pixels), 1}, file_bytes, options);
}

}  // namespace psfm
