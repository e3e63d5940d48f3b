// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/focal_prior.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stages/features/lensfun_crop_factor.h"

namespace psfm {
namespace {

constexpr double kFilmWidthMm = 36.0;
const double kFilmDiagonalMm = std::hypot(36.0, 24.0);

/// The exposure that a photograph comes from.
struct Original {
    double width;   ///< [px]
    double height;  ///< [px]
    double scale;   ///< pixels of the photograph per pixel of the original
};

Original original_of(const ExifTags& tags, double width, double height) {
    if (!tags.original_width || !tags.original_height) return {width, height, 1.0};
    double original_width = *tags.original_width;
    double original_height = *tags.original_height;
    // Programs that turn the pixels upright may leave the size as it was.
    if ((original_width > original_height) != (width > height))
        std::swap(original_width, original_height);
    return {original_width, original_height,
            std::max(width / original_width, height / original_height)};
}

std::optional<double> from_film_equivalent(const ExifTags& tags, const Original& original,
                                           FilmEquivalent film) {
    if (!tags.focal_35mm) return std::nullopt;
    const double per_film_mm = film == FilmEquivalent::kLongSide
                                   ? std::max(original.width, original.height) / kFilmWidthMm
                                   : std::hypot(original.width, original.height) / kFilmDiagonalMm;
    return *tags.focal_35mm * per_film_mm * original.scale;
}

std::optional<double> from_focal_plane(const ExifTags& tags, const Original& original) {
    if (!tags.focal_mm || !tags.focal_plane_x_per_mm) return std::nullopt;
    const double x_per_mm = *tags.focal_plane_x_per_mm;
    // The two axes differ by a fraction of a per cent in real cameras; by more, the tags are
    // broken.
    constexpr double kLargestDisagreement = 0.1;
    const double y_per_mm = tags.focal_plane_y_per_mm.value_or(x_per_mm);
    if (std::abs(y_per_mm / x_per_mm - 1.0) > kLargestDisagreement) return std::nullopt;
    // Sensors from small phones' to medium format; wrong units fall outside.
    const double sensor_mm = std::max(original.width, original.height) / x_per_mm;
    if (sensor_mm < 2.0 || sensor_mm > 80.0) return std::nullopt;
    return *tags.focal_mm * x_per_mm * original.scale;
}

std::optional<double> from_lensfun(const ExifTags& tags, const Original& original) {
    if (!tags.focal_mm || tags.model.empty()) return std::nullopt;
    const std::optional<double> crop = lensfun_crop_factor(tags.make, tags.model);
    if (!crop) return std::nullopt;
    return *tags.focal_mm * *crop * std::hypot(original.width, original.height) / kFilmDiagonalMm *
           original.scale;
}

/// Fields of view from a fisheye's to a telescope's.
bool is_possible(double focal_px, double width, double height) {
    const double ratio = focal_px / std::hypot(width, height);
    return ratio > 0.15 && ratio < 60.0;
}

}  // namespace

std::optional<double> focal_prior_px(const ExifTags& tags, std::uint32_t width,
                                     std::uint32_t height, FilmEquivalent film) {
    if (width == 0 || height == 0) return std::nullopt;
    const Original original = original_of(tags, width, height);
    auto focal_px = from_film_equivalent(tags, original, film);
    if (focal_px && is_possible(*focal_px, width, height)) return focal_px;
    focal_px = from_focal_plane(tags, original);
    if (focal_px && is_possible(*focal_px, width, height)) return focal_px;
    focal_px = from_lensfun(tags, original);
    if (focal_px && is_possible(*focal_px, width, height)) return focal_px;
    return std::nullopt;
}

}  // namespace psfm
