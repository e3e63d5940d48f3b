// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "stages/features/sift/find_places.h"

namespace psfm {

/// Rows around those that a strip answers for which describing its places looks at.
int reach_to_describe(const SiftOptions& options);

/// Finds orientations and descriptors, in buffers that it keeps. One thread at a time.
class PlaceDescriber {
  public:
    /// The directions of most gradient around a place (Lowe 2004, section 5): peaks of a smoothed
    /// histogram of 36 bins, of at least 0.8 of the highest, highest first, at most
    /// max_orientations.
    /// @return [rad, 0 … 2 pi, clockwise from the x axis]
    std::span<const float> orientations(const OctaveStrip& strip, const SiftPlace& place,
                                        const SiftOptions& options);

    /// Lowe 2004, section 6: 4 x 4 histograms of 8 directions, of length 1 twice, no value above
    /// 0.2 in between.
    std::span<const float, 128> descriptor(const OctaveStrip& strip, const SiftPlace& place,
                                           float orientation);

  private:
    /// Gradients of the pixels that count, their directions and lengths.
    struct Gradients {
        std::vector<float> dx, dy, weight, angle, length, row_bin, column_bin;  // at least `count`
        std::size_t count = 0;
        void make_room(std::size_t samples);
        void find_polar();
    };
    struct Window;
    void collect(const cv::Mat& image, const Window& window, int radius);

    Gradients gradients_;
    std::vector<float> directions_;
    std::array<float, 128> values_{};
};

}  // namespace psfm
