// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/picture_signature.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "stages/features/photographs/reduced_copy.h"

namespace psfm {
namespace {

/// By EXIF orientation (CIPA DC-008, 4.6.5 A), to how it was seen.
cv::Mat upright(const cv::Mat& stored, std::uint8_t orientation) {
    cv::Mat turned = stored;
    if (orientation >= 5) cv::transpose(stored, turned);
    const bool mirrored =
        orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
    const bool upside_down =
        orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
    if (!mirrored && !upside_down) return turned;
    cv::Mat result;
    cv::flip(turned, result, mirrored && upside_down ? -1 : (mirrored ? 1 : 0));
    return result;
}

}  // namespace

std::vector<std::uint8_t> picture_signature(const cv::Mat& grey, std::uint8_t orientation) {
    cv::Mat fields;
    cv::resize(grey, fields, {kSignatureSide, kSignatureSide}, 0, 0, cv::INTER_AREA);
    fields = upright(fields, orientation);
    return {fields.begin<std::uint8_t>(), fields.end<std::uint8_t>()};
}

}  // namespace psfm
