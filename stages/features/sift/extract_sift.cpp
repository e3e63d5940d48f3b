// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/sift/extract_sift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "stages/algorithms/math/in_parallel.h"
#include "stages/features/sift/choose_places.h"
#include "stages/features/sift/describe_place.h"
#include "stages/features/sift/find_places.h"
#include "stages/features/sift/gaussian_octave.h"
#include "stages/features/sift/root_sift.h"

namespace psfm {
namespace {

/// Guard: ends the octaves: of one whose shorter side is less, nearly all is rim [px].
constexpr int kMinOctaveSide = 16;
/// Guard: places that are described by one task: milliseconds, and buffers of its own.
constexpr std::size_t kPlacesATask = 256;

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

/// Pixel of the full image that a place lies in.
cv::Point pixel_of(const SiftPlace& place, const DetectionImage& image, cv::Size size) {
    return {std::clamp(static_cast<int>(std::floor(place.x * image.scale_x)), 0, size.width - 1),
            std::clamp(static_cast<int>(std::floor(place.y * image.scale_y)), 0, size.height - 1)};
}

/// The places that are kept, and the octaves that they are described in.
struct Detection {
    std::vector<OctaveSource> octaves;
    std::vector<SiftPlace> places;
};

Detection detect(const DetectionImage& image, const cv::Mat& mask, const SiftOptions& options) {
    Detection result;
    const auto add_octave = [&](const OctaveSource& octave, OctaveSource* next) {
        const std::size_t known = result.places.size();
        for_each_strip(octave, layers_to_detect(options), kReachToDetect, options,
                       [&](const OctaveStrip& strip) {
                           find_places(octave, strip, options, result.places);
                           if (next != nullptr) fill_next(strip, options, *next);
                       });
        result.octaves.push_back(octave);
        if (mask.empty()) return;
        const auto is_masked = [&](const SiftPlace& place) {
            return mask.at<std::uint8_t>(pixel_of(place, image, mask.size())) == 0;
        };
        result.places.erase(
            std::remove_if(result.places.begin() + static_cast<std::ptrdiff_t>(known),
                           result.places.end(), is_masked),
            result.places.end());
    };
    OctaveSource octave = first_octave(image.grey, 0);
    while (std::min(octave.size.width, octave.size.height) >= kMinOctaveSide) {
        OctaveSource next = next_octave(octave);
        add_octave(octave, &next);
        octave = std::move(next);
    }
    // The finest octave has three quarters of all pixels, and where the others have enough places,
    // none of those that are kept.
    choose_places(options, result.places);
    if (result.places.size() < options.max_features) {
        add_octave(first_octave(image.grey, -1), nullptr);
        choose_places(options, result.places);
    }
    return result;
}

struct Feature {
    Keypoint keypoint;
    std::array<std::uint8_t, Descriptors::kSize> descriptor{};
};

auto order_of(const Feature& feature) {
    const Keypoint& keypoint = feature.keypoint;
    return std::tuple(-keypoint.scale, keypoint.y, keypoint.x, keypoint.angle);
}

Keypoint to_keypoint(const SiftPlace& place, const DetectionImage& image, const cv::Mat& colour) {
    Keypoint keypoint;
    keypoint.x = place.x * image.scale_x;
    keypoint.y = place.y * image.scale_y;
    keypoint.scale = place.scale * std::sqrt(image.scale_x * image.scale_y);
    const auto& bgr = colour.at<cv::Vec3b>(pixel_of(place, image, colour.size()));
    keypoint.red = bgr[2];
    keypoint.green = bgr[1];
    keypoint.blue = bgr[0];
    return keypoint;
}

/// Features of places that a strip answers for.
void describe(std::span<const SiftPlace> places, const OctaveStrip& strip,
              const DetectionImage& image, const cv::Mat& colour, const SiftOptions& options,
              std::vector<Feature>& features) {
    PlaceDescriber describer;
    for (const SiftPlace& place : places) {
        Feature feature{to_keypoint(place, image, colour)};
        for (const float angle : describer.orientations(strip, place, options)) {
            feature.keypoint.angle = angle;
            write_root_sift(describer.descriptor(strip, place, angle), feature.descriptor);
            features.push_back(feature);
        }
    }
}

std::vector<Feature> describe(const Detection& detection, const DetectionImage& image,
                              const cv::Mat& colour, const SiftOptions& options) {
    std::vector<Feature> features;
    for (const OctaveSource& octave : detection.octaves) {
        std::vector<SiftPlace> places;
        for (const SiftPlace& place : detection.places) {
            if (place.octave == octave.index) places.push_back(place);
        }
        if (places.empty()) continue;
        std::ranges::sort(places, {}, &SiftPlace::row);
        std::span<const SiftPlace> left = places;
        const auto describe_rows = [&](const OctaveStrip& strip) {
            const auto beyond =
                std::ranges::lower_bound(left, static_cast<float>(strip.end), {}, &SiftPlace::row);
            const auto here = left.first(static_cast<std::size_t>(beyond - left.begin()));
            left = left.subspan(here.size());
            std::vector<std::vector<Feature>> parts((here.size() + kPlacesATask - 1) /
                                                    kPlacesATask);
            in_parallel(parts.size(), [&](std::size_t part) {
                const auto rest = here.subspan(part * kPlacesATask);
                describe(rest.first(std::min(kPlacesATask, rest.size())), strip, image, colour,
                         options, parts[part]);
            });
            for (const std::vector<Feature>& part : parts)
                features.insert(features.end(), part.begin(), part.end());
        };
        for_each_strip(octave, layers_to_describe(options), reach_to_describe(options), options,
                       describe_rows);
    }
    return features;
}

SiftFeatures in_order(std::vector<Feature> features) {
    std::ranges::sort(features, [](const Feature& a, const Feature& b) {
        return std::tuple(order_of(a), a.descriptor) < std::tuple(order_of(b), b.descriptor);
    });
    // std::unique: clang 14, which the fuzzers are built with, has no std::ranges::unique.
    const auto rest =
        std::unique(features.begin(), features.end(),
                    [](const Feature& a, const Feature& b) { return order_of(a) == order_of(b); });
    features.erase(rest, features.end());
    SiftFeatures result;
    result.keypoints.reserve(features.size());
    result.descriptors.values.reserve(features.size() * Descriptors::kSize);
    for (const Feature& feature : features) {
        result.keypoints.push_back(feature.keypoint);
        result.descriptors.values.insert(result.descriptors.values.end(),
                                         feature.descriptor.begin(), feature.descriptor.end());
    }
    return result;
}

}  // namespace

Result<SiftFeatures> extract_sift(const cv::Mat& grey, const cv::Mat& colour,
                                  const SiftOptions& options, const cv::Mat& mask) {
    if (Result<void> valid = validate(options); !valid.ok()) return valid.error();
    if (grey.empty() || grey.type() != CV_8UC1 || colour.type() != CV_8UC3 ||
        grey.size() != colour.size()) {
        return Error{
            ErrorCode::kInvalidArgument,
            "SIFT needs an 8-bit grey image and a BGR image of the same size; convert them first"};
    }
    if (!mask.empty() && (mask.type() != CV_8UC1 || mask.size() != grey.size())) {
        return Error{ErrorCode::kInvalidArgument,
                     "a mask has to be 8-bit, of one channel and of its photograph's size"};
    }
    try {
        const DetectionImage image = reduce(grey, options.max_image_size);
        const Detection detection = detect(image, mask, options);
        return in_order(describe(detection, image, colour, options));
    } catch (const cv::Exception& exception) {
        return Error{ErrorCode::kInternal,
                     "SIFT failed in OpenCV (" + exception.err + "); report this photograph"};
    }
}

}  // namespace psfm
