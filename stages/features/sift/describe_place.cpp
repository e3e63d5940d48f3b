// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/sift/describe_place.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/core/hal/hal.hpp>

namespace psfm {
namespace {

constexpr int kOrientationBins = 36;  // Mathematics: Lowe 2004, sec. 5
/// Mathematics: widths of the windows over sigma and what else makes a descriptor SIFT, as Lowe
/// 2004 (sec. 5 and 6) and OpenCV 4.6 have them.
constexpr float kOrientationSigma = 1.5F;
constexpr float kOrientationRadius = 3.F * kOrientationSigma;
constexpr float kPeakShare = 0.8F;
constexpr int kCells = 4;
constexpr int kDirections = 8;
constexpr float kCellWidth = 3.F;
constexpr float kLargestValue = 0.2F;
constexpr float kFullTurn = 2.F * std::numbers::pi_v<float>;

/// Largest sigma of a place in its octave: half a layer above the last that extrema are looked for
/// in.
double largest_sigma(const SiftOptions& options) {
    return options.sigma * std::pow(2.0, (options.octave_layers + 0.5) / options.octave_layers);
}

int descriptor_radius(double sigma) {
    return static_cast<int>(
        std::lround(kCellWidth * sigma * std::numbers::sqrt2 * 0.5 * (kCells + 1)));
}

std::size_t area_of(int radius) {
    const std::size_t width = 2 * static_cast<std::size_t>(radius) + 1;
    return width * width;
}

}  // namespace

int reach_to_describe(const SiftOptions& options) {
    // One for the gradient, one for the place's own row, half a pixel of refinement.
    return descriptor_radius(largest_sigma(options)) + 3;
}

void PlaceDescriber::Gradients::make_room(std::size_t samples) {
    for (std::vector<float>* values : {&dx, &dy, &weight, &angle, &length, &row_bin, &column_bin})
        if (values->size() < samples) values->resize(samples);
}

void PlaceDescriber::Gradients::find_polar() {
    if (count == 0) return;
    const int size = static_cast<int>(count);
    cv::hal::exp32f(weight.data(), weight.data(), size);
    cv::hal::fastAtan32f(dy.data(), dx.data(), angle.data(), size, true);  // degrees
    cv::hal::magnitude32f(dx.data(), dy.data(), length.data(), size);
}

std::span<const float> PlaceDescriber::orientations(const OctaveStrip& strip,
                                                    const SiftPlace& place,
                                                    const SiftOptions& options) {
    const cv::Mat& image = strip.layers[static_cast<std::size_t>(place.layer)];
    const int centre_x = static_cast<int>(std::lround(place.column));
    const int centre_y = static_cast<int>(std::lround(place.row)) - strip.first_row;
    const int radius = static_cast<int>(std::lround(kOrientationRadius * place.sigma));
    const float window = kOrientationSigma * place.sigma;
    const float factor = -0.5F / (window * window);
    gradients_.make_room(area_of(radius));
    std::size_t count = 0;
    for (int i = -radius; i <= radius; ++i) {
        const int y = centre_y + i;
        if (y <= 0 || y >= image.rows - 1) continue;
        const auto* above = image.ptr<float>(y - 1);
        const auto* line = image.ptr<float>(y);
        const auto* below = image.ptr<float>(y + 1);
        const int last_x = std::min(image.cols - 2, centre_x + radius);
        for (int x = std::max(1, centre_x - radius); x <= last_x; ++x, ++count) {
            const int j = x - centre_x;
            gradients_.dx[count] = line[x + 1] - line[x - 1];
            gradients_.dy[count] = below[x] - above[x];
            gradients_.weight[count] = static_cast<float>(i * i + j * j) * factor;
        }
    }
    gradients_.count = count;
    gradients_.find_polar();
    std::array<float, kOrientationBins> raw{};
    for (std::size_t k = 0; k < count; ++k) {
        auto bin = static_cast<int>(std::lround(gradients_.angle[k] * (kOrientationBins / 360.F)));
        bin %= kOrientationBins;
        raw[static_cast<std::size_t>(bin)] += gradients_.weight[k] * gradients_.length[k];
    }
    const auto of = [&](const std::array<float, kOrientationBins>& values, int bin) {
        return values[static_cast<std::size_t>((bin + kOrientationBins) % kOrientationBins)];
    };
    std::array<float, kOrientationBins> smooth{};
    for (int bin = 0; bin < kOrientationBins; ++bin) {
        smooth[static_cast<std::size_t>(bin)] = (of(raw, bin - 2) + of(raw, bin + 2)) / 16.F +
                                                (of(raw, bin - 1) + of(raw, bin + 1)) / 4.F +
                                                of(raw, bin) * 6.F / 16.F;
    }
    const float limit = kPeakShare * *std::ranges::max_element(smooth);
    std::vector<std::pair<float, float>> peaks;
    for (int bin = 0; bin < kOrientationBins; ++bin) {
        const float value = of(smooth, bin);
        const float left = of(smooth, bin - 1);
        const float right = of(smooth, bin + 1);
        if (value < limit || value <= left || value <= right) continue;
        const float exact =
            static_cast<float>(bin) + 0.5F * (left - right) / (left - 2.F * value + right);
        float angle = exact * kFullTurn / kOrientationBins;
        if (angle < 0.F) angle += kFullTurn;
        if (angle >= kFullTurn) angle -= kFullTurn;
        peaks.emplace_back(-value, angle);
    }
    std::ranges::sort(peaks);
    if (peaks.size() > options.max_orientations) peaks.resize(options.max_orientations);
    directions_.clear();
    for (const auto& peak : peaks) directions_.push_back(peak.second);
    return directions_;
}

/// The window of a descriptor: a square, turned by the orientation.
struct PlaceDescriber::Window {
    float centre_x = 0.F, centre_y = 0.F;
    float cosine = 0.F, sine = 0.F;  ///< of the orientation, over the width of a cell
    // Mathematics: half the window's width, in cells, and the half that bins reach beyond it.
    static constexpr float kHalf = 0.5F * kCells;
    static constexpr float kReach = kHalf + 0.5F;

    // Turned back by the orientation, in cells.
    float u(float dx, float dy) const { return cosine * dx + sine * dy; }
    float v(float dx, float dy) const { return cosine * dy - sine * dx; }
    bool holds(int x, float dy) const {
        const float dx = static_cast<float>(x) - centre_x;
        return std::abs(u(dx, dy)) < kReach && std::abs(v(dx, dy)) < kReach;
    }

    /// The columns from first_x to last_x of a row that it holds: first and last; nothing where
    /// first > last. A square is convex, so they have no gap.
    std::pair<int, int> columns(float dy, int first_x, int last_x) const {
        float low = static_cast<float>(first_x) - centre_x;
        float high = static_cast<float>(last_x) - centre_x;
        const auto narrow = [&](float slope, float offset) {  // |offset + slope * dx| < kReach
            if (std::abs(slope) < 1e-6F) return;
            const auto [from, to] =
                std::minmax({(-kReach - offset) / slope, (kReach - offset) / slope});
            low = std::max(low, from);
            high = std::min(high, to);
        };
        narrow(cosine, sine * dy);
        narrow(-sine, cosine * dy);
        // Rounded: the exact ones are found by looking.
        int first = std::max(first_x, static_cast<int>(std::floor(centre_x + low)) - 1);
        int last = std::min(last_x, static_cast<int>(std::ceil(centre_x + high)) + 1);
        while (first <= last && !holds(first, dy)) ++first;
        while (first <= last && !holds(last, dy)) --last;
        return {first, last};
    }
};

void PlaceDescriber::collect(const cv::Mat& image, const Window& window, int radius) {
    // Mathematics: the exponent of its Gaussian, of half its width (Lowe 2004, sec. 6.1).
    constexpr float kExponent = -1.F / (0.5F * kCells * kCells);
    const int middle_x = static_cast<int>(std::lround(window.centre_x));
    const int middle_y = static_cast<int>(std::lround(window.centre_y));
    const int last_y = std::min(image.rows - 2, middle_y + radius);
    gradients_.make_room(area_of(radius));
    std::size_t count = 0;
    for (int y = std::max(1, middle_y - radius); y <= last_y; ++y) {
        const float dy = static_cast<float>(y) - window.centre_y;
        const auto [first, last] = window.columns(dy, std::max(1, middle_x - radius),
                                                  std::min(image.cols - 2, middle_x + radius));
        const int columns = last - first + 1;
        const float* above = image.ptr<float>(y - 1) + first;
        const float* line = image.ptr<float>(y) + first;
        const float* below = image.ptr<float>(y + 1) + first;
        float* gradient_x = gradients_.dx.data() + count;
        float* gradient_y = gradients_.dy.data() + count;
        float* weight = gradients_.weight.data() + count;
        float* column_bin = gradients_.column_bin.data() + count;
        float* row_bin = gradients_.row_bin.data() + count;
        for (int i = 0; i < columns; ++i) {
            const float dx = static_cast<float>(first + i) - window.centre_x;
            const float u = window.u(dx, dy);
            const float v = window.v(dx, dy);
            gradient_x[i] = line[i + 1] - line[i - 1];
            gradient_y[i] = below[i] - above[i];
            weight[i] = (u * u + v * v) * kExponent;
            column_bin[i] = u + Window::kHalf - 0.5F;
            row_bin[i] = v + Window::kHalf - 0.5F;
        }
        count += static_cast<std::size_t>(std::max(0, columns));
    }
    gradients_.count = count;
    gradients_.find_polar();
}

std::span<const float, 128> PlaceDescriber::descriptor(const OctaveStrip& strip,
                                                       const SiftPlace& place, float orientation) {
    const float cell_width = kCellWidth * place.sigma;
    collect(strip.layers[static_cast<std::size_t>(place.layer)],
            {place.column, place.row - static_cast<float>(strip.first_row),
             std::cos(orientation) / cell_width, std::sin(orientation) / cell_width},
            descriptor_radius(place.sigma));

    // Mathematics: a cell more on either side, and a direction more, take what falls beyond.
    constexpr int kRowStep = (kCells + 2) * (kDirections + 1);
    constexpr int kColumnStep = kDirections + 1;
    std::array<float, static_cast<std::size_t>((kCells + 2) * kRowStep)> histogram{};
    const float turn = orientation * kDirections / kFullTurn;
    for (std::size_t k = 0; k < gradients_.count; ++k) {
        const float row = gradients_.row_bin[k] + 1.F;  // above 0
        const float column = gradients_.column_bin[k] + 1.F;
        // Counter-clockwise from the orientation, as OpenCV's descriptors have them.
        float direction = turn - gradients_.angle[k] * (kDirections / 360.F);
        if (direction < 0.F) direction += kDirections;
        if (direction >= kDirections) direction -= kDirections;
        // What lies just below kCells + 1 may be rounded up to it.
        const int row0 = std::min(static_cast<int>(row), kCells);
        const int column0 = std::min(static_cast<int>(column), kCells);
        const int direction0 = std::min(static_cast<int>(direction), kDirections - 1);
        const float dr = row - static_cast<float>(row0);
        const float dc = column - static_cast<float>(column0);
        const float dd = direction - static_cast<float>(direction0);
        const float value = gradients_.weight[k] * gradients_.length[k];
        float* cell = histogram.data() + row0 * kRowStep + column0 * kColumnStep + direction0;
        const float lower = value * (1.F - dr);
        const float upper = value * dr;
        const auto add = [&](float share, float* at) {
            at[0] += share * (1.F - dd);
            at[1] += share * dd;
        };
        add(lower * (1.F - dc), cell);
        add(lower * dc, cell + kColumnStep);
        add(upper * (1.F - dc), cell + kRowStep);
        add(upper * dc, cell + kRowStep + kColumnStep);
    }
    auto* next = values_.data();
    float squares = 0.F;
    for (int row = 1; row <= kCells; ++row) {
        for (int column = 1; column <= kCells; ++column) {
            float* cell = histogram.data() + row * kRowStep + column * kColumnStep;
            cell[0] += cell[kDirections];
            for (int k = 0; k < kDirections; ++k) {
                *next++ = cell[k];
                squares += cell[k] * cell[k];
            }
        }
    }
    const float largest = kLargestValue * std::sqrt(squares);
    float clamped = 0.F;
    for (float& value : values_) {
        value = std::min(value, largest);
        clamped += value * value;
    }
    const float scale = 1.F / std::max(std::sqrt(clamped), 1e-12F);
    for (float& value : values_) value *= scale;
    return values_;
}

}  // namespace psfm
