// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/colour_features.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "stages/features/cameras/photo_metadata.h"
#include "stages/features/photographs/read_photo.h"
#include "stages/features/photographs/text.h"

namespace psfm {
namespace {

int pixel_of(float coordinate, int size) {
    return static_cast<int>(std::clamp(std::floor(coordinate), 0.F, static_cast<float>(size - 1)));
}

Result<void> add(const PhotoFile& photo, const FeatureOptions& options, ExtractedPhoto& features) {
    const Result<DecodedPhoto> decoded = read_photo(photo, options.read);
    if (!decoded.ok()) return decoded.error();
    PhotoMetadata metadata = photo_metadata(*decoded, options.film_equivalent);
    if (metadata.width != features.metadata.width || metadata.height != features.metadata.height) {
        const auto size = [](const PhotoMetadata& of) {
            return std::to_string(of.width) + "x" + std::to_string(of.height);
        };
        return Error{ErrorCode::kInvalidArgument,
                     printable(photo.name) + ": the photograph has " + size(metadata) +
                         " pixels, its camera in the import " + size(features.metadata) +
                         ": name the folder of the photographs that the features were found in"};
    }
    for (Keypoint& keypoint : features.keypoints) {
        const auto& bgr = decoded->colour.at<cv::Vec3b>(pixel_of(keypoint.y, decoded->colour.rows),
                                                        pixel_of(keypoint.x, decoded->colour.cols));
        keypoint.red = bgr[2];
        keypoint.green = bgr[1];
        keypoint.blue = bgr[0];
    }
    features.metadata = std::move(metadata);
    return {};
}

}  // namespace

Result<void> add_photograph(const PhotoFile& photo, const FeatureOptions& options,
                            ExtractedPhoto& features) {
    try {
        return add(photo, options, features);
    } catch (const std::exception& exception) {
        return Error{ErrorCode::kInternal, printable(photo.name) + ": cannot be processed (" +
                                               printable(exception.what()) + ")"};
    }
}

}  // namespace psfm
