// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/cameras/focal_prior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "stages/features/cameras/lensfun_crop_factor.h"

namespace psfm {
namespace {

/// Mathematics: what "35 mm equivalent" is defined by.
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
    // Guard: the two axes differ by a fraction of a per cent in real cameras; by more, the tags are
    // broken.
    constexpr double kLargestDisagreement = 0.1;
    const double y_per_mm = tags.focal_plane_y_per_mm.value_or(x_per_mm);
    if (std::abs(y_per_mm / x_per_mm - 1.0) > kLargestDisagreement) return std::nullopt;
    // Guard: sensors from small phones' to medium format; wrong units fall outside.
    constexpr double kSmallestSensorMm = 2.0;
    constexpr double kLargestSensorMm = 80.0;
    const double sensor_mm = std::max(original.width, original.height) / x_per_mm;
    if (sensor_mm < kSmallestSensorMm || sensor_mm > kLargestSensorMm) return std::nullopt;
    return *tags.focal_mm * x_per_mm * original.scale;
}

std::optional<double> from_lensfun(const ExifTags& tags, const Original& original) {
    if (!tags.focal_mm || tags.model.empty()) return std::nullopt;
    const std::optional<double> crop = lensfun_crop_factor(tags.make, tags.model);
    if (!crop) return std::nullopt;
    return *tags.focal_mm * *crop * std::hypot(original.width, original.height) / kFilmDiagonalMm *
           original.scale;
}

/// Whether the field of view is between a fisheye's and a telescope's.
bool is_possible(double focal_px, double width, double height) {
    constexpr double kFisheye = 0.15;    // Guard: diagonals; what is shorter is a broken tag
    constexpr double kTelescope = 60.0;  // Guard: and what is longer
    const double ratio = focal_px / std::hypot(width, height);
    return ratio > kFisheye && ratio < kTelescope;
}

/// Whether a photograph has a shape that cameras give it: 1:1, 5:4, 4:3, 3:2, 16:10, 16:9, 17:9, or
/// one of the long ones of phones.
bool has_camera_shape(double width, double height) {
    // Guard: cameras round sizes to multiples of 8 or 16 pixels, which is no cropping.
    constexpr double kTolerance = 0.015;
    // Format: shapes of sensors and screens.
    constexpr std::array<double, 12> kShapes{1.0,       5.0 / 4,  4.0 / 3,  3.0 / 2,
                                             16.0 / 10, 16.0 / 9, 17.0 / 9, 2.0,
                                             18.5 / 9,  19.5 / 9, 20.0 / 9, 21.0 / 9};
    const double shape = std::max(width, height) / std::min(width, height);
    return std::ranges::any_of(
        kShapes, [&](double known) { return std::abs(shape / known - 1.0) < kTolerance; });
}

std::optional<double> if_possible(std::optional<double> focal_px, double width, double height) {
    return focal_px && is_possible(*focal_px, width, height) ? focal_px : std::nullopt;
}

/// With digital zoom the enlarged middle of the picture is all there is.
std::optional<double> zoomed(std::optional<double> focal_px, const ExifTags& tags) {
    return focal_px ? std::optional(*focal_px * tags.digital_zoom) : std::nullopt;
}

}  // namespace

FocalPrior focal_prior(const ExifTags& tags, std::uint32_t width, std::uint32_t height,
                       FilmEquivalent film) {
    if (width == 0 || height == 0) return {};
    constexpr double kHardlyZoomed = 1.01;  // Guard: rounding; less changes no focal length
    const Original original = original_of(tags, width, height);
    const bool is_zoomed = tags.digital_zoom > kHardlyZoomed;
    const bool is_cropped = !has_camera_shape(original.width, original.height);
    const auto by_film = if_possible(from_film_equivalent(tags, original, film), width, height);
    const auto by_plane =
        if_possible(zoomed(from_focal_plane(tags, original), tags), width, height);
    const auto by_lensfun = if_possible(zoomed(from_lensfun(tags, original), tags), width, height);
    FocalPrior prior;
    if (is_cropped) {
        prior.focal_px = by_plane ? by_plane : by_film ? zoomed(by_film, tags) : by_lensfun;
        prior.is_vague = prior.focal_px.has_value();
    } else if (is_zoomed) {
        prior.focal_px = by_plane ? by_plane : by_lensfun;
        if (!prior.focal_px) {
            prior.focal_px = if_possible(zoomed(by_film, tags), width, height);
            prior.is_vague = prior.focal_px.has_value();
        }
    } else {
        prior.focal_px = by_film ? by_film : by_plane ? by_plane : by_lensfun;
    }
    return prior;
}

}  // namespace psfm
