// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/undistortion/warp_photo.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace psfm {
namespace {

/// Guard: rows of a picture whose places in the photograph are worked out at a time.
constexpr int kStripRows = 64;
/// Guard: bicubic interpolation leaves pixels out below half the scale; reducing first costs time.
constexpr double kReduceBelow = 0.75;

/// Sizes of the photograph's pixels in the picture [px].
double scale_of(const UndistortedView& view) {
    const bool sideways = view.quarter_turns % 2 == 1;
    return sideways ? view.picture.fy() / view.photo.fx() : view.picture.fx() / view.photo.fx();
}

/// The photograph with about the picture's scale.
cv::Mat reduced(const cv::Mat& photo, double scale) {
    if (scale >= kReduceBelow) return photo;
    cv::Mat result;
    const cv::Size size(std::max(1, cvRound(photo.cols * scale)),
                        std::max(1, cvRound(photo.rows * scale)));
    cv::resize(photo, result, size, 0, 0, cv::INTER_AREA);
    return result;
}

/// @param photo  of any 8-bit type, which the result has, too
cv::Mat warp(const cv::Mat& photo, const UndistortedView& view, int interpolation) {
    const cv::Mat source = reduced(photo, scale_of(view));
    const double sx = static_cast<double>(source.cols) / photo.cols;
    const double sy = static_cast<double>(source.rows) / photo.rows;
    const auto width = static_cast<int>(view.picture.width);
    const auto height = static_cast<int>(view.picture.height);
    cv::Mat picture(height, width, photo.type());
    cv::Mat places(kStripRows, width, CV_32FC2);
    cv::Mat blank(kStripRows, width, CV_8U);
    for (int top = 0; top < height; top += kStripRows) {
        const int rows = std::min(kStripRows, height - top);
        bool any_blank = false;
        for (int row = 0; row < rows; ++row) {
            auto* place = places.ptr<cv::Vec2f>(row);
            auto* is_blank = blank.ptr<std::uint8_t>(row);
            for (int column = 0; column < width; ++column) {
                // Centres of pixels: 0.5 from their corners here, 0 in OpenCV.
                const Eigen::Vector2d at =
                    photo_from_picture(view, {column + 0.5, top + row + 0.5});
                place[column] = {static_cast<float>(at.x() * sx - 0.5),
                                 static_cast<float>(at.y() * sy - 0.5)};
                const bool outside =
                    at.x() < 0 || at.y() < 0 || at.x() > photo.cols || at.y() > photo.rows;
                is_blank[column] = outside ? 255 : 0;
                any_blank = any_blank || outside;
            }
        }
        cv::Mat strip = picture.rowRange(top, top + rows);
        // Half a pixel at the photograph's edge has no neighbour outside: it is its own.
        cv::remap(source, strip, places.rowRange(0, rows), cv::noArray(), interpolation,
                  cv::BORDER_REPLICATE);
        if (any_blank) strip.setTo(cv::Scalar::all(0), blank.rowRange(0, rows));
    }
    return picture;
}

}  // namespace

cv::Mat warp_photo(const cv::Mat& photo, const UndistortedView& view) {
    return warp(photo, view, cv::INTER_CUBIC);
}

cv::Mat warp_mask(const cv::Mat& visible, const UndistortedView& view) {
    return warp(visible, view, cv::INTER_LINEAR) >= 128;
}

}  // namespace psfm
