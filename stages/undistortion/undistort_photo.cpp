// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/undistortion/undistort_photo.h"

#include <exception>
#include <filesystem>
#include <new>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "stages/features/photographs/photo_mask.h"
#include "stages/features/photographs/read_file_bytes.h"
#include "stages/features/photographs/read_photo.h"
#include "stages/features/photographs/text.h"
#include "stages/undistortion/warp_photo.h"

namespace psfm {
namespace {

Error about(const PhotoFile& photo, const std::string& what,
            ErrorCode code = ErrorCode::kInvalidArgument) {
    return {code, printable(photo.name) + ": " + what};
}

std::vector<std::uint8_t> encode(const cv::Mat& picture, const std::string& extension,
                                 int jpeg_quality) {
    std::vector<int> parameters;
    // Format: of PNG: fast and nearly as small as can be: run lengths and Huffman codes do most of
    // it.
    constexpr int kPngCompression = 3;
    if (extension == ".jpg") parameters = {cv::IMWRITE_JPEG_QUALITY, jpeg_quality};
    if (extension == ".png") parameters = {cv::IMWRITE_PNG_COMPRESSION, kPngCompression};
    std::vector<std::uint8_t> bytes;
    cv::imencode(extension, picture, bytes, parameters);
    return bytes;
}

bool is_written_as(PhotoFormat format, const std::string& extension) {
    return extension == ".jpg" ? format == PhotoFormat::kJpeg : format == PhotoFormat::kPng;
}

/// What is to be seen of a photograph: all, where nothing hides any of it.
/// @param transparent  DecodedPhoto::mask
Result<cv::Mat> visible_part(const PhotoFile& photo, const cv::Mat& transparent, cv::Size size,
                             std::uint8_t orientation, const std::filesystem::path& folder) {
    cv::Mat visible =
        transparent.empty() ? cv::Mat(size, CV_8UC1, cv::Scalar(255)) : transparent.clone();
    if (folder.empty()) return visible;
    const auto file = find_mask(folder, photo);
    if (!file) return visible;
    const auto mask = read_mask(*file, size, orientation);
    if (!mask.ok())
        return Error{mask.error().code, printable(photo.name) + ": " + mask.error().message};
    cv::bitwise_and(visible, mask->visible, visible);
    return visible;
}

/// Half of the area counts, as at full size.
cv::Mat reduced_mask(const cv::Mat& mask, cv::Size size) {
    cv::Mat small;
    cv::resize(mask, small, size, 0, 0, cv::INTER_AREA);
    return small >= 128;
}

Result<PictureFiles> make_files(const PhotoFile& photo, std::uint64_t content_hash,
                                std::uint8_t orientation, const UndistortedView& view,
                                const PictureOptions& options) {
    std::error_code ignored;
    if (std::filesystem::status(photo.path, ignored).type() ==
        std::filesystem::file_type::not_found) {
        return about(photo,
                     "is not in its folder any more: put it back, or name the folder with "
                     "--images",
                     ErrorCode::kNotFound);
    }
    Result<DecodedPhoto> decoded = read_photo(photo, options.read);
    if (!decoded.ok()) return decoded.error();
    if (content_hash != 0 && decoded->content_hash != content_hash) {
        return about(photo,
                     "is not the photograph that the session knows (its content has "
                     "changed): put the old one back");
    }
    cv::Mat source = std::exchange(decoded->colour, {});
    decoded->grey.release();
    if (source.cols != static_cast<int>(view.photo.width) ||
        source.rows != static_cast<int>(view.photo.height)) {
        return about(photo,
                     "has another size than its camera in the session; `psfm check` looks "
                     "for damage");
    }
    const std::string extension = picture_extension(photo.name, options.format);
    const bool same = is_identity(view);
    PictureFiles files;
    cv::Mat mask;
    if (options.masks) {
        const auto visible =
            visible_part(photo, decoded->mask, source.size(), orientation, options.mask_folder);
        if (!visible.ok()) return visible.error();
        mask = same ? *visible : warp_mask(*visible, view);
        files.masks.push_back(encode(mask, ".png", options.jpeg_quality));
    }
    const cv::Mat picture = same ? source : warp_photo(source, view);
    source.release();
    if (same && orientation == 1 && is_written_as(decoded->format, extension)) {
        auto bytes = read_file_bytes(photo, std::uint64_t{options.read.max_file_mib} << 20U);
        if (!bytes.ok()) return bytes.error();
        files.bytes.push_back(*std::move(bytes));
    } else {
        files.bytes.push_back(encode(picture, extension, options.jpeg_quality));
    }
    for (const std::uint32_t factor : options.reductions) {
        const int divisor = static_cast<int>(factor);
        cv::Mat small;
        const cv::Size size(std::max(1, picture.cols / divisor),
                            std::max(1, picture.rows / divisor));
        cv::resize(picture, small, size, 0, 0, cv::INTER_AREA);
        files.bytes.push_back(encode(small, extension, options.jpeg_quality));
        if (options.masks)
            files.masks.push_back(encode(reduced_mask(mask, size), ".png", options.jpeg_quality));
    }
    return files;
}

}  // namespace

std::string picture_extension(std::string_view photo_name, PictureFormat format) {
    if (format == PictureFormat::kJpeg) return ".jpg";
    if (format == PictureFormat::kPng) return ".png";
    std::string extension = std::filesystem::path(photo_name).extension().string();
    for (char& character : extension) {
        if (character >= 'A' && character <= 'Z') character = static_cast<char>(character + 32);
    }
    return extension == ".png" ? ".png" : ".jpg";
}

Result<PictureFiles> undistort_photo(const PhotoFile& photo, std::uint64_t content_hash,
                                     std::uint8_t orientation, const UndistortedView& view,
                                     const PictureOptions& options) {
    try {
        return make_files(photo, content_hash, orientation, view, options);
    } catch (const std::bad_alloc&) {
        return about(photo, "not enough memory to undistort it; use fewer --threads",
                     ErrorCode::kInternal);
    } catch (const std::exception& exception) {
        return about(photo, "cannot be undistorted (" + printable(exception.what()) + ")",
                     ErrorCode::kInternal);
    }
}

}  // namespace psfm
