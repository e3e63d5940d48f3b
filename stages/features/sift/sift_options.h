// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"

namespace psfm {

/// Detection and description of SIFT features (Lowe, IJCV 2004).
struct SiftOptions {
    /// Larger photographs are reduced to this longer side before detection [px]; coordinates are
    /// given in the full photograph. Raised: slower; lowered: fewer and less exact features.
    /// Source: COLMAP 3.8, max_image_size.
    std::uint32_t max_image_size = 3200;
    /// The most places kept, largest scale first; a place has a feature for each of its
    /// orientations. Raised: matching time grows with its square; lowered: weakly overlapping
    /// pairs lose their matches. Source: COLMAP 3.8, max_num_features.
    std::uint32_t max_features = 8192;
    /// The most orientations of a place. Raised: more features, most of which match nothing more;
    /// lowered: places whose orientation is ambiguous match only by chance. Source: COLMAP 3.8,
    /// max_num_orientations.
    std::uint32_t max_orientations = 2;
    /// Layers in each octave of the scale space. Raised: slower, more but less stable features.
    /// Source: Lowe 2004, sec. 3.2.
    int octave_layers = 3;
    /// Least contrast of an extremum of the difference of Gaussians, times octave_layers, for grey
    /// values in 0 … 1. Raised: fewer features in shadows and on walls; lowered: noise is detected.
    /// Source: COLMAP 3.8, peak_threshold 0.02 / octave_resolution.
    double contrast_threshold = 0.02;
    /// Largest ratio of principal curvatures. Raised: more features along edges, badly localised.
    /// Source: Lowe 2004, sec. 4.1, and COLMAP 3.8.
    double edge_threshold = 10.0;
    /// Blur of the first layer, in pixels of the doubled image. Source: Lowe 2004, sec. 3.3.
    double sigma = 1.6;
    /// The scale space is made in strips of so much [MiB]. Raised: more memory; lowered: more rows
    /// are computed twice. Changes no bit of the result. Ours: a third of the rows at the width of
    /// 6,400 px that photographs of 3,200 px are doubled to (docs/features.md, "In strips").
    std::uint32_t strip_mib = 96;
};

/// @errors kInvalidArgument, naming the field and its range
Result<void> validate(const SiftOptions& options);

}  // namespace psfm
