// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/decode_pixels.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "stages/features/photographs/photo_mask.h"

namespace psfm {
namespace {

Error undecodable(PhotoFormat format) {
    return {ErrorCode::kUnreadable,
            "cannot be decoded: its " + std::string(format_name(format)) +
                " data are damaged or of an unusual kind; copy the file again, or "
                "export it as 8-bit JPEG or PNG"};
}

}  // namespace

cv::Mat scale_to_8_bits(const cv::Mat& deep) {
    double largest = 0.0;
    cv::minMaxLoc(deep.reshape(1), nullptr, &largest);
    int bits = 10;
    while (bits < 16 && largest >= static_cast<double>(1 << bits)) bits += 2;
    cv::Mat result;
    deep.convertTo(result, CV_8U, 255.0 / static_cast<double>((1 << bits) - 1));
    return result;
}

Result<DecodedPixels> decode_pixels(std::span<const std::uint8_t> bytes, PhotoFormat format) {
    // OpenCV wants a mutable pointer but only reads.
    const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8U,
                         const_cast<std::uint8_t*>(bytes.data()));
    // As they are, where they may hold transparency; that never turns by EXIF's orientation.
    const bool may_be_transparent =
        format == PhotoFormat::kPng || format == PhotoFormat::kTiff || format == PhotoFormat::kWebp;
    DecodedPixels decoded;
    cv::Mat& pixels = decoded.colour;
    try {
        if (may_be_transparent) pixels = cv::imdecode(buffer, cv::IMREAD_UNCHANGED);
        const bool is_simple = pixels.depth() == CV_8U || pixels.depth() == CV_16U;
        if (is_simple && pixels.channels() == 4) {
            cv::Mat alpha;
            cv::extractChannel(pixels, alpha, 3);
            decoded.mask = mask_from_alpha(alpha);
            cv::cvtColor(pixels, pixels, cv::COLOR_BGRA2BGR);
        } else if (!is_simple || pixels.channels() != 3) {
            pixels = cv::imdecode(
                buffer, cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
        }
    } catch (const cv::Exception&) {
        return undecodable(format);
    }
    if (pixels.empty() || pixels.channels() != 3) return undecodable(format);
    if (pixels.depth() == CV_8U) return decoded;
    if (pixels.depth() == CV_16U) {
        pixels = scale_to_8_bits(pixels);
        return decoded;
    }
    return Error{
        ErrorCode::kUnreadable,
        "has floating-point or signed pixels; export it as 8- or 16-bit TIFF, PNG or JPEG"};
}

}  // namespace psfm
