// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/sift/gaussian_octave.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "stages/algorithms/math/in_parallel.h"

namespace psfm {
namespace {

/// Mathematics: blur that a photograph is supposed to have [px]. Source: Lowe 2004, sec. 3.3.
constexpr double kCameraBlur = 0.5;

/// Kernels end at 4 sigma, as OpenCV's and VLFeat's.
int radius_of(double sigma) {
    return static_cast<int>(std::ceil(4.0 * sigma));
}

void blur(const cv::Mat& from, cv::Mat& to, double sigma) {
    const int size = 2 * radius_of(sigma) + 1;
    to.create(from.size(), CV_32F);
    in_parallel(bands_of(from.rows), [&](std::size_t band) {
        const int begin = static_cast<int>(band) * kRowsOfBand;
        const cv::Range rows(begin, std::min(begin + kRowsOfBand, from.rows));
        cv::Mat part = to.rowRange(rows);
        // It sees the rows beside the band. At the strip's own rim it comes out wrong where the
        // strip is all that there is, and that is not used.
        cv::GaussianBlur(from.rowRange(rows), part, {size, size}, sigma, sigma,
                         cv::BORDER_REFLECT_101);
    });
}

/// Blur that makes a layer of the one before it; of layer 0 of an octave that is made of the 8-bit
/// image, of that; else none.
double added_blur(const OctaveSource& octave, int layer, const SiftOptions& options) {
    if (layer == 0) {
        if (octave.pixels.depth() != CV_8U) return 0.0;
        const double before = octave.index < 0 ? 2.0 * kCameraBlur : kCameraBlur;
        return std::sqrt(std::max(options.sigma * options.sigma - before * before, 0.01));
    }
    const double step = std::pow(2.0, 1.0 / options.octave_layers);
    return options.sigma * std::pow(step, layer - 1) * std::sqrt(step * step - 1.0);
}

/// Rows of the source on either side that a layer's row depends on, all layers.
int margin_of(const OctaveSource& octave, int layers, const SiftOptions& options) {
    int margin = 0;
    for (int layer = 0; layer < layers; ++layer) {
        const double sigma = added_blur(octave, layer, options);
        if (sigma > 0.0) margin += radius_of(sigma);
    }
    return margin;
}

/// Rows [begin, end) of the octave before any blur, as float.
cv::Mat unblurred(const OctaveSource& octave, int begin, int end) {
    if (octave.pixels.depth() != CV_8U) return octave.pixels.rowRange(begin, end);
    cv::Mat rows;
    if (octave.index == 0) {
        const int above = std::max(0, begin - 1);
        octave.pixels.rowRange(above, end).convertTo(rows, CV_32F);
        const cv::Matx12f quarter(0.25F, 0.75F);
        cv::sepFilter2D(rows, rows, CV_32F, quarter, quarter, {1, 1}, 0.0, cv::BORDER_REPLICATE);
        return rows.rowRange(begin - above, end - above);
    }
    // Between two rows and columns each, at a quarter and three quarters: rows further up and down
    // do not matter, and where there is none, the last one counts twice.
    const int first = std::max(0, begin / 2 - 1);
    const int last = std::min(octave.pixels.rows, (end + 1) / 2 + 1);
    cv::Mat single;
    octave.pixels.rowRange(first, last).convertTo(single, CV_32F);
    cv::resize(single, rows, {2 * single.cols, 2 * single.rows}, 0, 0, cv::INTER_LINEAR);
    return rows.rowRange(begin - 2 * first, end - 2 * first);
}

}  // namespace

OctaveSource first_octave(const cv::Mat& grey, int index) {
    assert(grey.type() == CV_8UC1 && (index == 0 || index == -1));
    // Every other pixel of the doubled one, a quarter of a pixel further up and left: so both
    // octaves have the same interpolation, and go on one from the other.
    if (index == 0) return {0, 0.25F, 1.F, grey.size(), grey};
    return {-1, 0.25F, 0.5F, {2 * grey.cols, 2 * grey.rows}, grey};
}

int rows_of_strip(const OctaveSource& octave, int layers, int reach, const SiftOptions& options) {
    // One layer more is what blurring takes.
    const std::size_t row = static_cast<std::size_t>(octave.size.width) * sizeof(float) *
                            static_cast<std::size_t>(layers + 1);
    const std::size_t held = (std::size_t{options.strip_mib} << 20U) / row;
    const int beside = 2 * (margin_of(octave, layers, options) + reach);
    // Never less than half as much as what lies beside: the work would grow many times.
    return std::max(static_cast<int>(std::min<std::size_t>(held, 1U << 20U)) - beside, beside / 2);
}

void for_each_strip(const OctaveSource& octave, int layers, int reach, const SiftOptions& options,
                    const std::function<void(const OctaveStrip&)>& visit) {
    const int margin = margin_of(octave, layers, options) + reach;
    const int rows = rows_of_strip(octave, layers, reach, options);
    OctaveStrip strip;
    strip.height = octave.size.height;
    strip.layers.resize(static_cast<std::size_t>(layers));
    for (int begin = 0; begin < strip.height; begin = strip.end) {
        strip.begin = begin;
        strip.end = std::min(strip.height, begin + rows);
        // A rest that its neighbour can hold as well is no strip of its own.
        if (strip.height - strip.end < margin / 2) strip.end = strip.height;
        strip.first_row = std::max(0, begin - margin);
        const int last = std::min(strip.height, strip.end + margin);
        const cv::Mat source = unblurred(octave, strip.first_row, last);
        const double first = added_blur(octave, 0, options);
        if (first > 0.0) {
            blur(source, strip.layers[0], first);
        } else {
            strip.layers[0] = source;
        }
        for (int layer = 1; layer < layers; ++layer) {
            const auto i = static_cast<std::size_t>(layer);
            blur(strip.layers[i - 1], strip.layers[i], added_blur(octave, layer, options));
        }
        visit(strip);
    }
}

OctaveSource next_octave(const OctaveSource& octave) {
    OctaveSource next;
    next.index = octave.index + 1;
    next.origin = octave.origin;
    next.pitch = 2.F * octave.pitch;
    next.size = {(octave.size.width + 1) / 2, (octave.size.height + 1) / 2};
    next.pixels = cv::Mat(next.size, CV_32F);
    return next;
}

void fill_next(const OctaveStrip& strip, const SiftOptions& options, OctaveSource& next) {
    const cv::Mat& layer = strip.layers[static_cast<std::size_t>(options.octave_layers)];
    for (int row = (strip.begin + 1) / 2 * 2; row < strip.end; row += 2) {
        const auto* from = layer.ptr<float>(row - strip.first_row);
        auto* to = next.pixels.ptr<float>(row / 2);
        for (int column = 0; column < next.size.width; ++column) to[column] = from[2 * column];
    }
}

}  // namespace psfm
