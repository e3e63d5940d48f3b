// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "stages/features/sift/gaussian_octave.h"

namespace psfm {

/// An extremum of the difference of Gaussians, with one orientation or several: where features are.
struct SiftPlace {
    int octave = 0;
    int layer = 0;         ///< of the octave: the one to describe it in
    float column = 0.F;    ///< [px of the octave, 0 at a pixel's centre], refined
    float row = 0.F;       ///< likewise
    float sigma = 0.F;     ///< [px of the octave]
    float contrast = 0.F;  ///< |difference of Gaussians| there, grey values 0 … 1
    float x = 0.F;         ///< [px of the image, origin at the corner]
    float y = 0.F;
    float scale = 0.F;  ///< sigma [px of the image]
};

/// Mathematics: rows around those that a strip answers for which finding its places looks at.
inline constexpr int kReachToDetect = 7;

/// The places whose extremum lies in rows that the strip answers for, row by row (Lowe 2004,
/// sections 3.1 and 4): maxima and minima among 26 neighbours, refined by a quadric at most five
/// times, without those of little contrast and those along edges.
/// REQUIRES: strip.layers.size() == layers_to_detect(options). Appends. Thread-safe.
void find_places(const OctaveSource& octave, const OctaveStrip& strip, const SiftOptions& options,
                 std::vector<SiftPlace>& places);

}  // namespace psfm
