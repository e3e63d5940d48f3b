// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/cameras/focal_prior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "stages/features/cameras/lensfun_crop_factor.h"

namespace psfm {
namespace {

const double kFilmDiagonal = std::hypot(36.0, 24.0);

std::optional<double> prior(const ExifTags& tags, std::uint32_t width, std::uint32_t height) {
    return focal_prior(tags, width, height, FilmEquivalent::kDiagonal).focal_px;
}

TEST(FocalPriorTest, FilmEquivalentComparesDiagonals) {
    ExifTags tags;
    tags.focal_35mm = 35.0;
    EXPECT_NEAR(prior(tags, 2832, 2128).value(), 35.0 * std::hypot(2832, 2128) / kFilmDiagonal,
                1e-9);
    // 3:2 photographs: the same as comparing widths.
    EXPECT_NEAR(prior(tags, 3600, 2400).value(), 3500.0, 1e-9);
}

TEST(FocalPriorTest, FilmEquivalentMayCompareTheLongSide) {
    ExifTags tags;
    tags.focal_35mm = 28.0;
    EXPECT_NEAR(focal_prior(tags, 900, 675, FilmEquivalent::kLongSide).focal_px.value(), 700.0,
                1e-9);
    EXPECT_NEAR(focal_prior(tags, 675, 900, FilmEquivalent::kLongSide).focal_px.value(), 700.0,
                1e-9);
}

TEST(FocalPriorTest, FocalPlaneResolution) {
    ExifTags tags;
    tags.focal_mm = 5.40625;
    tags.focal_plane_x_per_mm = 640000.0 / 206.0 / 25.4;
    EXPECT_NEAR(prior(tags, 640, 480).value(), 661.26, 0.01);
}

TEST(FocalPriorTest, ReducedPhotographsScale) {
    ExifTags tags;
    tags.focal_mm = 50.0;
    tags.focal_plane_x_per_mm = 100.0;  // 36 mm over 3,600 pixels
    tags.original_width = 3600.0;
    tags.original_height = 2400.0;
    EXPECT_NEAR(prior(tags, 3600, 2400).value(), 5000.0, 1e-9);
    EXPECT_NEAR(prior(tags, 900, 600).value(), 1250.0, 1e-9);
    // Turned upright by a program that left the size as it was.
    EXPECT_NEAR(prior(tags, 600, 900).value(), 1250.0, 1e-9);
}

TEST(FocalPriorTest, CroppedPhotographsKeepTheirFocalLength) {
    ExifTags tags;
    tags.focal_35mm = 36.0;
    tags.original_width = 3600.0;
    tags.original_height = 2400.0;
    EXPECT_NEAR(prior(tags, 3600, 1800).value(), 3600.0, 1e-9);
    EXPECT_NEAR(prior(tags, 1000, 667 - 200).value(), 1000.0, 1e-9);
}

TEST(FocalPriorTest, OrderOfSources) {
    ExifTags tags;
    tags.make = "NIKON CORPORATION";
    tags.model = "NIKON D70";
    tags.focal_mm = 36.0;
    const auto crop = lensfun_crop_factor(tags.make, tags.model);
    if (!crop) GTEST_SKIP() << "Lensfun's database is not installed";
    EXPECT_NEAR(*crop, 1.52, 0.03);
    EXPECT_NEAR(prior(tags, 3000, 2000).value(), 3000.0 * *crop, 0.1);
    tags.focal_plane_x_per_mm = 100.0;
    EXPECT_NEAR(prior(tags, 3000, 2000).value(), 3600.0, 1e-6);
    tags.focal_35mm = 50.0;
    EXPECT_NEAR(prior(tags, 3000, 2000).value(), 3000.0 * 50.0 / 36.0, 1e-6);
}

bool is_vague(const ExifTags& tags, std::uint32_t width, std::uint32_t height) {
    return focal_prior(tags, width, height, FilmEquivalent::kDiagonal).is_vague;
}

TEST(FocalPriorTest, DigitalZoomIsALongerFocalLength) {
    ExifTags tags;
    tags.focal_mm = 36.0;
    tags.focal_plane_x_per_mm = 100.0;
    tags.digital_zoom = 1.5;
    EXPECT_NEAR(prior(tags, 3600, 2400).value(), 5400.0, 1e-9);
    EXPECT_FALSE(is_vague(tags, 3600, 2400));
    // The equivalent may have the zoom in it already: the sensor is believed.
    tags.focal_35mm = 54.0;
    EXPECT_NEAR(prior(tags, 3600, 2400).value(), 5400.0, 1e-9);
    EXPECT_FALSE(is_vague(tags, 3600, 2400));
    // Without the sensor nobody knows.
    tags.focal_plane_x_per_mm.reset();
    EXPECT_TRUE(prior(tags, 3600, 2400));
    EXPECT_TRUE(is_vague(tags, 3600, 2400));
    tags.digital_zoom = 1.0;
    EXPECT_NEAR(prior(tags, 3600, 2400).value(), 5400.0, 1e-9);
    EXPECT_FALSE(is_vague(tags, 3600, 2400));
}

TEST(FocalPriorTest, AShapeThatNoCameraHasWasCropped) {
    ExifTags tags;
    tags.focal_35mm = 35.0;
    EXPECT_TRUE(is_vague(tags, 2000, 1650));
    EXPECT_TRUE(is_vague(tags, 1650, 2000));
    for (const auto& [width, height] :
         {std::pair(4000, 3000), std::pair(3008, 2000), std::pair(1920, 1080), std::pair(800, 1067),
          std::pair(1000, 1000), std::pair(1067, 800), std::pair(2400, 1080)}) {
        EXPECT_FALSE(
            is_vague(tags, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)))
            << width;
    }
    // The sensor's pixels are what they were, if nobody has reduced them.
    tags.focal_mm = 36.0;
    tags.focal_plane_x_per_mm = 100.0;
    EXPECT_NEAR(prior(tags, 2000, 1650).value(), 3600.0, 1e-9);
    // Where EXIF has the size that it was cropped from, that tells.
    tags.original_width = 3600.0;
    tags.original_height = 2400.0;
    EXPECT_FALSE(is_vague(tags, 2000, 1650));
}

TEST(FocalPriorTest, LensfunIgnoresCaseAndBlanks) {
    const auto crop = lensfun_crop_factor("NIKON CORPORATION", "NIKON D70");
    if (!crop) GTEST_SKIP() << "Lensfun's database is not installed";
    EXPECT_EQ(lensfun_crop_factor(" Nikon  Corporation", "nikon d70 "), crop);
    EXPECT_FALSE(lensfun_crop_factor("NIKON CORPORATION", "no such camera"));
    EXPECT_FALSE(lensfun_crop_factor("", ""));
}

TEST(FocalPriorTest, ImpossibleSourcesGiveWayToTheNext) {
    ExifTags tags;
    EXPECT_FALSE(prior(tags, 640, 480));
    tags.focal_mm = 5.0;
    EXPECT_FALSE(prior(tags, 640, 480));
    tags.focal_plane_x_per_mm = 1.0;  // a sensor 64 cm wide
    EXPECT_FALSE(prior(tags, 640, 480));
    tags.focal_plane_x_per_mm = 128.0;
    tags.focal_plane_y_per_mm = 64.0;  // pixels twice as high as wide
    EXPECT_FALSE(prior(tags, 640, 480));
    tags.focal_plane_y_per_mm = 127.5;
    EXPECT_TRUE(prior(tags, 640, 480));
    tags.focal_35mm = 60000.0;  // no lens: the focal plane tells
    EXPECT_NEAR(prior(tags, 640, 480).value(), 640.0, 1e-9);
    EXPECT_FALSE(prior(tags, 0, 480));
}

}  // namespace
}  // namespace psfm
