// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/sift/gaussian_octave.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/stages/features/photo_fixture.h"

namespace psfm {
namespace {

cv::Mat grey_image(int width, int height) {
    cv::Mat grey;
    cv::cvtColor(testing::textured_image(width, height), grey, cv::COLOR_BGR2GRAY);
    return grey;
}

/// All layers of an octave, put together of strips, and how many there were.
struct Assembled {
    std::vector<cv::Mat> layers;
    int strips = 0;
};

Assembled assemble(const OctaveSource& octave, std::uint32_t strip_mib, int layers) {
    SiftOptions options;
    options.strip_mib = strip_mib;
    Assembled result;
    for (int i = 0; i < layers; ++i)
        result.layers.emplace_back(octave.size, CV_32F, cv::Scalar(-1.0));
    int row = 0;
    const int reach = 20;
    for_each_strip(octave, layers, reach, options, [&](const OctaveStrip& strip) {
        EXPECT_EQ(strip.begin, row);
        EXPECT_EQ(strip.height, octave.size.height);
        row = strip.end;
        ++result.strips;
        const int first = std::max(0, strip.begin - reach);
        const int last = std::min(strip.height, strip.end + reach);
        for (int i = 0; i < layers; ++i) {
            const auto at = static_cast<std::size_t>(i);
            const cv::Mat rows =
                strip.layers[at].rowRange(first - strip.first_row, last - strip.first_row);
            const cv::Mat known = result.layers[at].rowRange(first, strip.begin);
            EXPECT_TRUE(known.empty() ||
                        cv::norm(known, rows.rowRange(0, known.rows), cv::NORM_INF) == 0.0);
            rows.copyTo(result.layers[at].rowRange(first, last));
        }
    });
    EXPECT_EQ(row, octave.size.height);
    return result;
}

TEST(GaussianOctaveTest, StripsOfAnyHeightHoldTheSameBits) {
    const cv::Mat grey = grey_image(700, 501);
    for (const int index : {-1, 0}) {
        const OctaveSource octave = first_octave(grey, index);
        const Assembled whole = assemble(octave, 1000, 6);
        EXPECT_EQ(whole.strips, 1);
        const Assembled parts = assemble(octave, 1, 6);
        EXPECT_GT(parts.strips, 3);
        for (std::size_t i = 0; i < 6; ++i)
            EXPECT_EQ(cv::norm(whole.layers[i], parts.layers[i], cv::NORM_INF), 0.0) << i;
    }
}

TEST(GaussianOctaveTest, BandsOfRowsHoldTheBitsOfTheWhole) {
    const OctaveSource octave = first_octave(grey_image(700, 501), 0);
    const SiftOptions options;
    const Assembled whole = assemble(octave, 1000, 2);
    const double step = std::pow(2.0, 1.0 / options.octave_layers);
    const double sigma = options.sigma * std::sqrt(step * step - 1.0);
    const int side = 2 * static_cast<int>(std::ceil(4.0 * sigma)) + 1;
    cv::Mat blurred;
    cv::GaussianBlur(whole.layers[0], blurred, {side, side}, sigma, sigma, cv::BORDER_REFLECT_101);
    ASSERT_GT(bands_of(blurred.rows), 3U);
    EXPECT_EQ(cv::norm(whole.layers[1], blurred, cv::NORM_INF), 0.0);
}

TEST(GaussianOctaveTest, TheNextOctaveIsTheSameFromStripsOfAnyHeight) {
    const OctaveSource octave = first_octave(grey_image(700, 501), 0);
    const auto next_of = [&](std::uint32_t strip_mib) {
        SiftOptions options;
        options.strip_mib = strip_mib;
        OctaveSource next = next_octave(octave);
        next.pixels = cv::Scalar(-1.0);
        for_each_strip(octave, 6, 7, options,
                       [&](const OctaveStrip& strip) { fill_next(strip, options, next); });
        return next;
    };
    const OctaveSource next = next_of(1000);
    EXPECT_EQ(next.size, cv::Size(350, 251));
    EXPECT_EQ(next.index, 1);
    double least = 0.0;
    cv::minMaxLoc(next.pixels, &least);
    EXPECT_GE(least, 0.0);  // every pixel is there
    EXPECT_EQ(cv::norm(next.pixels, next_of(1).pixels, cv::NORM_INF), 0.0);
}

/// Blurs add up: layer i is the doubled image under one blur of sigma 2^(i/3), less the camera's;
/// the octave of the image is every other pixel of that.
TEST(GaussianOctaveTest, LayersHaveTheirBlur) {
    const cv::Mat grey = grey_image(200, 150);
    const Assembled doubled = assemble(first_octave(grey, -1), 1000, 6);
    const Assembled octave = assemble(first_octave(grey, 0), 1000, 6);
    cv::Mat image;
    grey.convertTo(image, CV_32F);
    cv::resize(image, image, {400, 300}, 0, 0, cv::INTER_LINEAR);
    for (int i = 0; i < 6; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const double sigma = 1.6 * std::pow(2.0, i / 3.0);
        cv::Mat expected;
        cv::GaussianBlur(image, expected, {61, 61}, std::sqrt(sigma * sigma - 1.0));
        EXPECT_LT(cv::norm(doubled.layers[at], expected, cv::NORM_INF), 0.5) << i;
        cv::GaussianBlur(image, expected, {121, 121}, std::sqrt(4.0 * sigma * sigma - 1.0));
        for (int y = 10; y < 140; ++y) {
            for (int x = 10; x < 190; ++x) {
                ASSERT_NEAR(octave.layers[at].at<float>(y, x), expected.at<float>(2 * y, 2 * x),
                            0.5)
                    << i;
            }
        }
    }
}

/// Of a photograph of 24 megapixels, reduced to 3,200 px or whole: the strips stay within their
/// budget, and what lies beside them is a small part of them.
TEST(GaussianOctaveTest, StripsStayWithinTheirBudget) {
    const SiftOptions options;
    for (const cv::Size size : {cv::Size(3200, 2133), cv::Size(2133, 3200), cv::Size(6000, 4000)}) {
        const OctaveSource octave = first_octave(cv::Mat(size, CV_8U), -1);
        const int layers = layers_to_detect(options);
        const int rows = rows_of_strip(octave, layers, 7, options);
        const std::size_t held = static_cast<std::size_t>(rows + 2 * (47 + 7)) * sizeof(float) *
                                 static_cast<std::size_t>(octave.size.width) *
                                 static_cast<std::size_t>(layers + 1);
        EXPECT_LE(held, std::size_t{options.strip_mib} << 20U) << size;
        EXPECT_GE(rows, 108) << size;
    }
}

}  // namespace
}  // namespace psfm
