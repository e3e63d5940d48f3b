// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/decode_pixels.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

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

Result<cv::Mat> decode_pixels(std::span<const std::uint8_t> bytes, PhotoFormat format) {
    // OpenCV wants a mutable pointer but only reads.
    const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8U,
                         const_cast<std::uint8_t*>(bytes.data()));
    cv::Mat pixels;
    try {
        pixels = cv::imdecode(
            buffer, cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
    } catch (const cv::Exception&) {
        return undecodable(format);
    }
    if (pixels.empty() || pixels.channels() != 3) return undecodable(format);
    if (pixels.depth() == CV_8U) return pixels;
    if (pixels.depth() == CV_16U) return scale_to_8_bits(pixels);
    return Error{
        ErrorCode::kUnreadable,
        "has floating-point or signed pixels; export it as 8- or 16-bit TIFF, PNG or JPEG"};
}

}  // namespace psfm
