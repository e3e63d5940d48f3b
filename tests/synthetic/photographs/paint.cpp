// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/photographs/paint.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

/// Fraction bits of OpenCV's drawing coordinates: shapes start between texels.
constexpr int kShift = 4;

cv::Point fixed_point(double x, double y) {
    constexpr double kOne = 1 << kShift;
    return {static_cast<int>(std::lround(x * kOne)), static_cast<int>(std::lround(y * kOne))};
}

cv::Scalar random_colour(Rng& rng, double low, double high) {
    // Mostly grey with a tint: photographs are not confetti.
    const double grey = rng.uniform(low, high);
    const double blue = grey + rng.uniform(-30.0, 20.0);
    const double green = grey + rng.uniform(-20.0, 20.0);
    const double red = grey + rng.uniform(-15.0, 35.0);
    return {blue, green, red};
}

double square_metres(const cv::Mat3b& image, double texels_per_metre) {
    return static_cast<double>(image.total()) / (texels_per_metre * texels_per_metre);
}

/// Sum of octaves of smoothed random numbers, about -1 … 1, from `coarsest` texels down to 2.
cv::Mat1f mottle(cv::Size size, double coarsest, Rng& rng) {
    cv::Mat1f sum(size, 0.F);
    double amplitude = 0.5;
    for (double cell = coarsest; cell >= 2.0; cell *= 0.5, amplitude *= 0.75) {
        cv::Mat1f coarse(static_cast<int>(size.height / cell) + 2,
                         static_cast<int>(size.width / cell) + 2);
        for (float& value : coarse) value = static_cast<float>(rng.uniform(-1.0, 1.0));
        cv::Mat1f fine;
        cv::resize(coarse, fine, size, 0, 0, cv::INTER_CUBIC);
        cv::scaleAdd(fine, amplitude, sum, sum);
    }
    return sum;
}

/// Rows of stones of random width and height; the joints between them show what was there before.
void lay_stones(cv::Mat3b& image, double texels_per_metre, double mean_height, double mean_width,
                Rng& rng) {
    const double joint = 0.012 * texels_per_metre;
    for (double top = 0.0; top < image.rows;) {
        const double height = mean_height * texels_per_metre * rng.uniform(0.6, 1.4);
        double left = -rng.uniform() * mean_width * texels_per_metre;
        while (left < image.cols) {
            const double width = mean_width * texels_per_metre * rng.uniform(0.5, 1.6);
            const auto wobble = [&] { return joint * rng.uniform(0.2, 1.6); };
            std::vector<cv::Point> corners;
            for (int corner = 0; corner < 4; ++corner) {
                const bool right = corner == 1 || corner == 2;
                const double inset_x = wobble();
                const double inset_y = wobble();
                corners.push_back(
                    fixed_point(right ? left + width - inset_x : left + inset_x,
                                corner >= 2 ? top + height - inset_y : top + inset_y));
            }
            cv::fillConvexPoly(image, corners, random_colour(rng, 70.0, 190.0), cv::LINE_AA,
                               kShift);
            left += width;
        }
        top += height;
    }
}

void add_stains(cv::Mat3b& image, double texels_per_metre, double per_square_metre, Rng& rng) {
    const double area = square_metres(image, texels_per_metre);
    const auto count = static_cast<int>(area * per_square_metre);
    for (int i = 0; i < count; ++i) {
        // Sizes from 8 mm to 20 cm: small ones are far more frequent.
        const double radius =
            0.008 * std::pow(25.0, std::pow(rng.uniform(), 2.5)) * texels_per_metre;
        const double x = rng.uniform(0.0, image.cols);
        const double y = rng.uniform(0.0, image.rows);
        const double flat = rng.uniform(0.4, 1.0);
        const double turn_deg = rng.uniform(0.0, 180.0);
        cv::ellipse(image, fixed_point(x, y), fixed_point(radius, radius * flat), turn_deg, 0.0,
                    360.0, random_colour(rng, 20.0, 235.0), cv::FILLED, cv::LINE_AA, kShift);
    }
}

/// Strokes between the nine knots of a small grid, as letters are, each sign another one.
void add_signs(cv::Mat3b& image, double texels_per_metre, double per_square_metre, Rng& rng) {
    const double area = square_metres(image, texels_per_metre);
    const auto count = static_cast<int>(area * per_square_metre);
    for (int i = 0; i < count; ++i) {
        const double size = rng.uniform(0.05, 0.30) * texels_per_metre;
        const double x = rng.uniform(0.0, image.cols);
        const double y = rng.uniform(0.0, image.rows);
        const double turn = rng.uniform(0.0, 2.0 * std::numbers::pi);
        const cv::Scalar ink = random_colour(rng, rng.below(2) == 0 ? 15.0 : 190.0, 240.0);
        const int thickness = std::max(1, static_cast<int>(size * rng.uniform(0.06, 0.16)));
        const auto knot = [&] {
            const double a = (static_cast<double>(rng.below(3)) - 1.0) * 0.35 * size;
            const double b = (static_cast<double>(rng.below(3)) - 1.0) * 0.5 * size;
            return fixed_point(x + a * std::cos(turn) - b * std::sin(turn),
                               y + a * std::sin(turn) + b * std::cos(turn));
        };
        const std::size_t strokes = 3 + rng.below(3);
        cv::Point from = knot();
        for (std::size_t stroke = 0; stroke < strokes; ++stroke) {
            const cv::Point to = knot();
            cv::line(image, from, to, ink, thickness, cv::LINE_AA, kShift);
            from = to;
        }
    }
}

}  // namespace

cv::Mat paint_texture(cv::Size texels, double texels_per_metre, Paint paint, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 40));
    cv::Mat3b image(texels);
    const cv::Scalar base = random_colour(rng, 90.0, 170.0);
    image.setTo(base);
    if (paint == Paint::kBricks) lay_stones(image, texels_per_metre, 0.16, 0.38, rng);
    if (paint == Paint::kPaving) lay_stones(image, texels_per_metre, 0.5, 0.6, rng);
    add_stains(image, texels_per_metre, 45.0, rng);
    add_signs(image, texels_per_metre, 9.0, rng);
    // Mottling over everything, so that no surface is flat at any scale.
    const cv::Mat1f shade = mottle(texels, texels_per_metre, rng);
    const cv::Mat1f grain = mottle(texels, 8.0, rng);
    for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
            const float factor = 1.0F + 0.22F * shade(y, x) + 0.10F * grain(y, x);
            for (int channel = 0; channel < 3; ++channel) {
                std::uint8_t& value = image(y, x)[channel];
                value = cv::saturate_cast<std::uint8_t>(static_cast<float>(value) * factor);
            }
        }
    }
    return image;
}

}  // namespace psfm::synthetic
