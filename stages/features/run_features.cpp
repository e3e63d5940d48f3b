// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/run_features.h"

#include <exception>
#include <new>
#include <opencv2/core.hpp>
#include <string>
#include <utility>

#include "stages/features/cameras/photo_metadata.h"
#include "stages/features/photographs/photo_mask.h"
#include "stages/features/photographs/picture_signature.h"
#include "stages/features/photographs/read_photo.h"
#include "stages/features/photographs/text.h"
#include "stages/features/sift/extract_sift.h"

namespace psfm {
namespace {

/// Adds what a mask file hides, if there is one, to what the photograph itself does.
Result<void> apply_mask_file(const PhotoFile& photo, const std::filesystem::path& masks,
                             const PhotoMetadata& metadata, cv::Mat& mask, std::uint64_t& hash) {
    if (masks.empty()) return {};
    const auto file = find_mask(masks, photo);
    if (!file) return {};
    const auto read =
        read_mask(*file, {static_cast<int>(metadata.width), static_cast<int>(metadata.height)},
                  metadata.orientation);
    // Whatever is wrong with a mask, it may be put right while the photograph stays as it is.
    if (!read.ok())
        return Error{ErrorCode::kIo, printable(photo.name) + ": " + read.error().message};
    hash = read->hash;
    if (mask.empty())
        mask = read->visible;
    else
        cv::bitwise_and(mask, read->visible, mask);
    return {};
}

Result<ExtractedPhoto> extract(const PhotoFile& photo, const FeatureOptions& options) {
    if (Result<void> valid = validate(options); !valid.ok()) return valid.error();
    Result<DecodedPhoto> decoded = read_photo(photo, options.read);
    if (!decoded.ok()) return decoded.error();
    PhotoMetadata metadata = photo_metadata(*decoded, options.film_equivalent);
    std::uint64_t mask_hash = 0;
    if (Result<void> masked =
            apply_mask_file(photo, options.masks, metadata, (*decoded).mask, mask_hash);
        !masked.ok())
        return masked.error();
    Result<SiftFeatures> features =
        extract_sift(decoded->grey, decoded->colour, options.sift, decoded->mask);
    if (!features.ok()) {
        return Error{features.error().code,
                     printable(photo.name) + ": " + features.error().message};
    }
    auto signature = picture_signature(decoded->grey, metadata.orientation);
    return ExtractedPhoto{std::move(metadata),
                          std::move(features->keypoints),
                          std::move(features->descriptors),
                          std::move(decoded->remarks),
                          std::move(signature),
                          mask_hash};
}

}  // namespace

Result<ExtractedPhoto> run_features(const PhotoFile& photo, const FeatureOptions& options) {
    try {
        return extract(photo, options);
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::kInternal,
                     printable(photo.name) +
                         ": not enough memory to read it; use fewer --threads, or reduce it"};
    } catch (const std::exception& exception) {
        return Error{ErrorCode::kInternal, printable(photo.name) + ": cannot be processed (" +
                                               printable(exception.what()) +
                                               "); export it as JPEG"};
    } catch (...) {
        return Error{ErrorCode::kInternal,
                     printable(photo.name) + ": cannot be processed; export it as JPEG"};
    }
}

}  // namespace psfm
