// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/extract_sift.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "stages/features/root_sift.h"

namespace psfm {
namespace {

/// From OpenCV 4.6's coordinates (origin at the first pixel's centre) to ours (origin at its
/// corner): half a pixel, less the quarter by which its keypoints sit right and below of the true
/// position, because doubling the image maps pixel i to 2 i + 1/2 and OpenCV halves without taking
/// the 1/2 off. Test: blob_position_test.
constexpr float kCornerFromKeypoint = 0.25F;

/// The image to detect in, and pixels of the full image per pixel of it.
struct DetectionImage {
    cv::Mat grey;
    float scale_x = 1.F;
    float scale_y = 1.F;
};

DetectionImage reduce(const cv::Mat& grey, std::uint32_t max_image_size) {
    const int longer = std::max(grey.cols, grey.rows);
    if (longer <= static_cast<int>(max_image_size)) return {grey};
    const double factor = static_cast<double>(max_image_size) / longer;
    const cv::Size size(std::max(1, static_cast<int>(std::lround(grey.cols * factor))),
                        std::max(1, static_cast<int>(std::lround(grey.rows * factor))));
    DetectionImage result;
    cv::resize(grey, result.grey, size, 0, 0, cv::INTER_AREA);  // keeps corners on corners
    result.scale_x = static_cast<float>(grey.cols) / static_cast<float>(size.width);
    result.scale_y = static_cast<float>(grey.rows) / static_cast<float>(size.height);
    return result;
}

Keypoint to_keypoint(const cv::KeyPoint& found, const DetectionImage& image,
                     const cv::Mat& colour) {
    Keypoint keypoint;
    keypoint.x = (found.pt.x + kCornerFromKeypoint) * image.scale_x;
    keypoint.y = (found.pt.y + kCornerFromKeypoint) * image.scale_y;
    // OpenCV's size is the blob's diameter, 2 sigma.
    keypoint.scale = 0.5F * found.size * std::sqrt(image.scale_x * image.scale_y);
    keypoint.angle = found.angle * std::numbers::pi_v<float> / 180.F;
    const int column = std::clamp(static_cast<int>(std::floor(keypoint.x)), 0, colour.cols - 1);
    const int row = std::clamp(static_cast<int>(std::floor(keypoint.y)), 0, colour.rows - 1);
    const auto& bgr = colour.at<cv::Vec3b>(row, column);
    keypoint.red = bgr[2];
    keypoint.green = bgr[1];
    keypoint.blue = bgr[0];
    return keypoint;
}

auto order_of(const Keypoint& keypoint) {
    return std::tuple(-keypoint.scale, keypoint.y, keypoint.x, keypoint.angle);
}

/// Sorts, removes exact duplicates, cuts to max_features, and writes the descriptors.
SiftFeatures order_features(const Keypoints& keypoints, const cv::Mat& sift,
                            std::uint32_t max_features) {
    std::vector<int> rows(keypoints.size());
    std::iota(rows.begin(), rows.end(), 0);
    const auto key = [&](int row) { return order_of(keypoints[static_cast<std::size_t>(row)]); };
    std::stable_sort(rows.begin(), rows.end(), [&](int a, int b) { return key(a) < key(b); });
    rows.erase(
        std::unique(rows.begin(), rows.end(), [&](int a, int b) { return key(a) == key(b); }),
        rows.end());
    if (rows.size() > max_features) rows.resize(max_features);

    SiftFeatures result;
    result.keypoints.reserve(rows.size());
    result.descriptors.values.resize(rows.size() * Descriptors::kSize);
    auto next = result.descriptors.values.begin();
    for (const int row : rows) {
        result.keypoints.push_back(keypoints[static_cast<std::size_t>(row)]);
        write_root_sift({sift.ptr<float>(row), Descriptors::kSize}, {next, Descriptors::kSize});
        next += Descriptors::kSize;
    }
    return result;
}

}  // namespace

Result<SiftFeatures> extract_sift(const cv::Mat& grey, const cv::Mat& colour,
                                  const SiftOptions& options) {
    if (Result<void> valid = validate(options); !valid) return valid.error();
    if (grey.empty() || grey.type() != CV_8UC1 || colour.type() != CV_8UC3 ||
        grey.size() != colour.size()) {
        return Error{
            ErrorCode::kInvalidArgument,
            "SIFT needs an 8-bit grey image and a BGR image of the same size; convert them first"};
    }
    try {
        const DetectionImage image = reduce(grey, options.max_image_size);
        const int candidates =
            static_cast<int>(options.max_features * options.candidates_per_feature);
        const cv::Ptr<cv::SIFT> detector =
            cv::SIFT::create(candidates, options.octave_layers, options.contrast_threshold,
                             options.edge_threshold, options.sigma, CV_32F);
        std::vector<cv::KeyPoint> found;
        cv::Mat sift;
        detector->detectAndCompute(image.grey, cv::noArray(), found, sift);
        Keypoints keypoints;
        keypoints.reserve(found.size());
        for (const cv::KeyPoint& keypoint : found)
            keypoints.push_back(to_keypoint(keypoint, image, colour));
        return order_features(keypoints, sift, options.max_features);
    } catch (const cv::Exception& exception) {
        return Error{ErrorCode::kInternal,
                     "SIFT failed in OpenCV (" + exception.err + "); report this photograph"};
    }
}

}  // namespace psfm
