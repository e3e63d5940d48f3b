// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "stages/features/sift/sift_options.h"

namespace psfm {

/// One octave of a Gaussian scale space (Lowe, IJCV 2004, section 3): what its layers are made of.
/// Layer i has the blur sigma * 2^(i / octave_layers) in the octave's pixels.
struct OctaveSource {
    int index = 0;  ///< -1: the doubled image, 0: every other pixel of that, 1: of this …
    /// Where pixel 0's centre is, and how far pixels are apart, in pixels of the image with the
    /// origin at the corner of its first pixel.
    float origin = 0.5F;
    float pitch = 1.F;
    cv::Size size;   ///< of the octave
    cv::Mat pixels;  ///< 8-bit: the image (of octaves -1 and 0); float: layer 0 of this octave
};

/// Rows of an octave, in all or the first of its layers.
struct OctaveStrip {
    std::vector<cv::Mat> layers;  ///< float, grey values 0 … 255, equally large
    int first_row = 0;            ///< the octave's row that row 0 of the layers is
    int begin = 0, end = 0;       ///< the octave's rows that this strip answers for
    int height = 0;               ///< rows of the octave
};

/// The octave of the doubled image (index -1), or the next one, which is made without it (0).
/// grey: CV_8U.
OctaveSource first_octave(const cv::Mat& grey, int index);

/// Guard: rows that one task blurs, or looks for extrema in: enough that what it does twice beside
/// them (26 rows of the widest blur) hardly counts.
inline constexpr int kRowsOfBand = 128;
/// Bands that so many rows make.
inline std::size_t bands_of(int rows) {
    return static_cast<std::size_t>((rows + kRowsOfBand - 1) / kRowsOfBand);
}

/// Layers that finding extrema takes, and that descriptions are made of.
inline int layers_to_detect(const SiftOptions& options) {
    return options.octave_layers + 3;
}
inline int layers_to_describe(const SiftOptions& options) {
    return options.octave_layers + 1;
}

/// Rows that a strip of so many bytes answers for, beside what it has to hold of its neighbours.
int rows_of_strip(const OctaveSource& octave, int layers, int reach, const SiftOptions& options);

/// Calls `visit` for one strip after another, from the top. What a strip's layers hold of rows
/// [begin - reach, end + reach) within the octave is what the layers of the whole octave hold, bit
/// by bit, whatever the strips' heights.
/// @param layers  how many are made
void for_each_strip(const OctaveSource& octave, int layers, int reach, const SiftOptions& options,
                    const std::function<void(const OctaveStrip&)>& visit);

/// As large as the next octave's layer 0 has to be: every other pixel of this one's.
OctaveSource next_octave(const OctaveSource& octave);
/// Fills those rows of `next.pixels` that come from rows that the strip answers for.
void fill_next(const OctaveStrip& strip, const SiftOptions& options, OctaveSource& next);

}  // namespace psfm
