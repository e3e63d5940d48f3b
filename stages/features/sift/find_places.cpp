// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/sift/find_places.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/hal/intrin.hpp>
#include <optional>

#include "stages/algorithms/math/in_parallel.h"

namespace psfm {
namespace {

/// Guard: pixels along the octave's rim without places, so that the refinement's steps stay inside.
/// Source: OpenCV 4.6.
constexpr int kBorder = 5;
/// Guard: steps of the refinement. Source: OpenCV 4.6 and VLFeat 0.9.
constexpr int kMaxSteps = 5;
/// Guard: steps beyond which the quadric says nothing [px or layers].
constexpr float kFurthest = 1e4F;
static_assert(kReachToDetect >= kMaxSteps + 2);

/// Differences of neighbouring layers at rows of the octave.
class Differences {
  public:
    explicit Differences(const OctaveStrip& strip) : strip_(strip) {}

    float at(int layer, int row, int column) const {
        const auto i = static_cast<std::size_t>(layer);
        const int y = row - strip_.first_row;
        return strip_.layers[i + 1].at<float>(y, column) - strip_.layers[i].at<float>(y, column);
    }

    void write(int layer, int row, float* to) const {
        const auto i = static_cast<std::size_t>(layer);
        const int y = row - strip_.first_row;
        const auto* lower = strip_.layers[i].ptr<float>(y);
        const auto* upper = strip_.layers[i + 1].ptr<float>(y);
        const int width = strip_.layers[i].cols;
        for (int x = 0; x < width; ++x) to[x] = upper[x] - lower[x];
    }

  private:
    const OctaveStrip& strip_;
};

/// Three rows of every difference, one after the other, and the extremes of three rows.
class RowWindow {
  public:
    RowWindow(const Differences& differences, int layers, int width)
        : differences_(differences),
          rows_(3 * layers, width, CV_32F),
          largest_(layers, width, CV_32F, cv::Scalar(0)),
          smallest_(layers, width, CV_32F, cv::Scalar(0)),
          layers_(layers) {}

    void load(int row) {
        for (int layer = 0; layer < layers_; ++layer)
            differences_.write(layer, row, of(layer, row));
    }

    /// Extremes of the nine differences around each pixel of a row, all layers.
    /// REQUIRES: its neighbours are loaded.
    void find_extremes(int row) {
        for (int layer = 0; layer < layers_; ++layer) {
            const float* a = of(layer, row - 1);
            const float* b = of(layer, row);
            const float* c = of(layer, row + 1);
            float* high = largest_.ptr<float>(layer);
            float* low = smallest_.ptr<float>(layer);
            const int width = rows_.cols;
            int x = 1;
            for (; x + 5 <= width; x += 4) {
                using cv::v_load;
                using cv::v_max;
                using cv::v_min;
                auto most = v_max(v_max(v_load(a + x), v_load(b + x)), v_load(c + x));
                auto least = v_min(v_min(v_load(a + x), v_load(b + x)), v_load(c + x));
                for (const int side : {-1, 1}) {
                    const auto p = v_load(a + x + side);
                    const auto q = v_load(b + x + side);
                    const auto r = v_load(c + x + side);
                    most = v_max(most, v_max(v_max(p, q), r));
                    least = v_min(least, v_min(v_min(p, q), r));
                }
                cv::v_store(high + x, most);
                cv::v_store(low + x, least);
            }
            for (; x + 1 < width; ++x) {
                high[x] = low[x] = b[x];
                for (const float* line : {a, b, c}) {
                    for (int side = -1; side <= 1; ++side) {
                        high[x] = std::max(high[x], line[x + side]);
                        low[x] = std::min(low[x], line[x + side]);
                    }
                }
            }
        }
    }

    /// Columns of a layer's extrema in a row, of those that find_extremes() was called for.
    template <typename Visit>
    void visit_extrema(int layer, int row, float threshold, const Visit& visit) {
        const float* value = of(layer, row);
        const std::array<const float*, 3> high{largest_.ptr<float>(layer - 1),
                                               largest_.ptr<float>(layer),
                                               largest_.ptr<float>(layer + 1)};
        const std::array<const float*, 3> low{smallest_.ptr<float>(layer - 1),
                                              smallest_.ptr<float>(layer),
                                              smallest_.ptr<float>(layer + 1)};
        const auto is_extremum = [&](int x) {
            const float v = value[x];
            return (v > threshold && v >= high[0][x] && v >= high[1][x] && v >= high[2][x]) ||
                   (v < -threshold && v <= low[0][x] && v <= low[1][x] && v <= low[2][x]);
        };
        const int end = rows_.cols - kBorder;
        const cv::v_float32x4 above = cv::v_setall_f32(threshold);
        const cv::v_float32x4 below = cv::v_setall_f32(-threshold);
        int x = kBorder;
        for (; x + 4 <= end; x += 4) {
            const auto v = cv::v_load(value + x);
            // Among nine of its own layer first: hardly any group of four is left then.
            const auto maximum = (v > above) & (v >= cv::v_load(high[1] + x));
            const auto minimum = (v < below) & (v <= cv::v_load(low[1] + x));
            if (!cv::v_check_any(maximum | minimum)) continue;
            for (int lane = 0; lane < 4; ++lane) {
                if (is_extremum(x + lane)) visit(x + lane);
            }
        }
        for (; x < end; ++x) {
            if (is_extremum(x)) visit(x);
        }
    }

  private:
    float* of(int layer, int row) { return rows_.ptr<float>(3 * layer + row % 3); }

    const Differences& differences_;
    cv::Mat rows_;
    cv::Mat largest_;
    cv::Mat smallest_;
    int layers_;
};

struct Extremum {
    int layer = 0, row = 0, column = 0;
    std::array<float, 3> offset{};  ///< column, row, layer
    float contrast = 0.F;           ///< signed, grey values 0 … 255
};

/// Derivatives of the difference of Gaussians at a pixel, by column (x), row (y) and layer (s).
struct Quadric {
    float centre = 0.F;
    float x = 0.F, y = 0.F, s = 0.F;
    float xx = 0.F, xy = 0.F, xs = 0.F, yy = 0.F, ys = 0.F, ss = 0.F;

    Quadric(const Differences& d, int l, int r, int c)
        : centre(d.at(l, r, c)),
          x(0.5F * (d.at(l, r, c + 1) - d.at(l, r, c - 1))),
          y(0.5F * (d.at(l, r + 1, c) - d.at(l, r - 1, c))),
          s(0.5F * (d.at(l + 1, r, c) - d.at(l - 1, r, c))),
          xx(d.at(l, r, c + 1) + d.at(l, r, c - 1) - 2.F * centre),
          xy(0.25F * (d.at(l, r + 1, c + 1) - d.at(l, r + 1, c - 1) - d.at(l, r - 1, c + 1) +
                      d.at(l, r - 1, c - 1))),
          xs(0.25F * (d.at(l + 1, r, c + 1) - d.at(l + 1, r, c - 1) - d.at(l - 1, r, c + 1) +
                      d.at(l - 1, r, c - 1))),
          yy(d.at(l, r + 1, c) + d.at(l, r - 1, c) - 2.F * centre),
          ys(0.25F * (d.at(l + 1, r + 1, c) - d.at(l + 1, r - 1, c) - d.at(l - 1, r + 1, c) +
                      d.at(l - 1, r - 1, c))),
          ss(d.at(l + 1, r, c) + d.at(l - 1, r, c) - 2.F * centre) {}

    /// Where its derivatives vanish; not finite where it has no such point.
    std::array<float, 3> extremum() const {
        const float yy_ss = yy * ss - ys * ys;
        const float xy_ss = xy * ss - ys * xs;
        const float xy_ys = xy * ys - yy * xs;
        const float determinant = xx * yy_ss - xy * xy_ss + xs * xy_ys;
        return {-(x * yy_ss - y * xy_ss + s * xy_ys) / determinant,
                -(-x * xy_ss + y * (xx * ss - xs * xs) - s * (xx * ys - xy * xs)) / determinant,
                -(x * xy_ys - y * (xx * ys - xy * xs) + s * (xx * yy - xy * xy)) / determinant};
    }

    float at(const std::array<float, 3>& offset) const {
        return centre + 0.5F * (x * offset[0] + y * offset[1] + s * offset[2]);
    }

    bool is_edge(float largest_ratio) const {
        const float trace = xx + yy;
        const float determinant = xx * yy - xy * xy;
        return determinant <= 0.F || trace * trace * largest_ratio >= (largest_ratio + 1.F) *
                                                                          (largest_ratio + 1.F) *
                                                                          determinant;
    }
};

/// Lowe 2004, section 4: the extremum of a quadric through the neighbours, from that pixel which it
/// lies nearest to.
std::optional<Extremum> refine(const Differences& d, Extremum at, const OctaveStrip& strip,
                               int width, const SiftOptions& options) {
    const int start = at.row;
    for (int step = 0; step < kMaxSteps; ++step) {
        const Quadric quadric(d, at.layer, at.row, at.column);
        at.offset = quadric.extremum();
        float furthest = 0.F;
        for (const float offset : at.offset) {
            // Beyond, or not a number: the neighbours tell nothing of it.
            if (!(std::abs(offset) < kFurthest)) return std::nullopt;
            furthest = std::max(furthest, std::abs(offset));
        }
        if (furthest < 0.5F) {
            at.contrast = quadric.at(at.offset);
            const float limit = static_cast<float>(options.contrast_threshold) * 255.F;
            if (std::abs(at.contrast) * static_cast<float>(options.octave_layers) < limit ||
                quadric.is_edge(static_cast<float>(options.edge_threshold)))
                return std::nullopt;
            return at;
        }
        at.column += static_cast<int>(std::lround(at.offset[0]));
        at.row += static_cast<int>(std::lround(at.offset[1]));
        at.layer += static_cast<int>(std::lround(at.offset[2]));
        if (at.layer < 1 || at.layer > options.octave_layers || at.column < kBorder ||
            at.column >= width - kBorder || at.row < kBorder || at.row >= strip.height - kBorder ||
            std::abs(at.row - start) > kReachToDetect - 2)
            return std::nullopt;
    }
    return std::nullopt;
}

/// The place that a refined extremum is.
SiftPlace place_of(const Extremum& found, const OctaveSource& octave, const SiftOptions& options) {
    SiftPlace place;
    place.octave = octave.index;
    place.layer = found.layer;
    place.column = static_cast<float>(found.column) + found.offset[0];
    place.row = static_cast<float>(found.row) + found.offset[1];
    const float level = static_cast<float>(found.layer) + found.offset[2];
    place.sigma = static_cast<float>(
        options.sigma * std::pow(2.0, static_cast<double>(level) / options.octave_layers));
    place.contrast = std::abs(found.contrast) / 255.F;
    place.x = octave.origin + octave.pitch * place.column;
    place.y = octave.origin + octave.pitch * place.row;
    place.scale = octave.pitch * place.sigma;
    return place;
}

/// The places whose extremum lies in rows [first, last), appended.
void find_in_rows(int first, int last, const OctaveSource& octave, const OctaveStrip& strip,
                  const SiftOptions& options, std::vector<SiftPlace>& places) {
    const int width = octave.size.width;
    const auto threshold =
        static_cast<float>(0.5 * options.contrast_threshold / options.octave_layers * 255.0);
    const Differences differences(strip);
    RowWindow window(differences, options.octave_layers + 2, width);
    window.load(first - 1);
    window.load(first);
    for (int row = first; row < last; ++row) {
        window.load(row + 1);
        window.find_extremes(row);
        for (int layer = 1; layer <= options.octave_layers; ++layer) {
            window.visit_extrema(layer, row, threshold, [&](int column) {
                const auto found =
                    refine(differences, {layer, row, column, {}, 0.F}, strip, width, options);
                if (found) places.push_back(place_of(*found, octave, options));
            });
        }
    }
}

}  // namespace

void find_places(const OctaveSource& octave, const OctaveStrip& strip, const SiftOptions& options,
                 std::vector<SiftPlace>& places) {
    assert(static_cast<int>(strip.layers.size()) == layers_to_detect(options));
    const int first = std::max(strip.begin, kBorder);
    const int last = std::min(strip.end, strip.height - kBorder);
    if (octave.size.width <= 2 * kBorder || first >= last) return;
    std::vector<std::vector<SiftPlace>> bands(bands_of(last - first));
    in_parallel(bands.size(), [&](std::size_t band) {
        const int begin = first + static_cast<int>(band) * kRowsOfBand;
        find_in_rows(begin, std::min(begin + kRowsOfBand, last), octave, strip, options,
                     bands[band]);
    });
    for (const std::vector<SiftPlace>& band : bands)
        places.insert(places.end(), band.begin(), band.end());
}

}  // namespace psfm
