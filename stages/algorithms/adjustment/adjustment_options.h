// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"

namespace psfm {

/// How bundle adjustment weighs, and when it stops.
struct AdjustmentOptions {
    /// Residuals beyond this many pixels lose weight (soft L1). Higher: outliers pull more; lower:
    /// slower convergence from a rough start. COLMAP 3.8 uses 1 in local adjustments.
    double loss_scale_px = 1.0;
    /// Iterations at most. COLMAP 3.8: 50 for global, 25 for local adjustments.
    int max_iterations = 50;
    /// Stop when a step improves the cost by less than this fraction. Higher: faster, less
    /// accurate. Ours; not tuned; Ceres has 1e-6, COLMAP 3.8 0.
    double function_tolerance = 1e-6;
    /// Memory of the reduced camera system, up to which it is formed point by point and factorised
    /// by tiles, and nothing else is kept. Empty tiles take none: 3,800 images that all see each
    /// other have 2 GiB, 3,500 in streets 169 MiB. Lowered: Ceres solves it,
    /// and takes 1.4 kB an observation. Ours (docs/performance.md, "Memory").
    std::uint32_t max_reduced_mib = 2048;
    /// Standard deviation of an observation over its feature's scale, 1 px at least. 0: all count
    /// alike, as in COLMAP. Higher: large features count less. Ours, tuned on Strecha's scenes
    /// (docs/accuracy.md): 1 divides the error on Herz-Jesus-P8 by 1.1 and costs 2 % on the others.
    double sigma_per_scale = 1.0;
    /// Standard deviation of a principal point from the image's centre, over the longer side, where
    /// it is free. Higher: scenes that hardly determine it move it far; lower: what lenses really
    /// have is not found. Ours: the Strecha cameras have 0.007, and 0.003 or 0.01 give the same
    /// within a fifth (docs/accuracy.md).
    double principal_point_sigma = 0.005;
};

Result<void> validate(const AdjustmentOptions& options);

/// How far what is right may be off, by a model's noise.
struct NoiseBounds {
    /// Width of the loss, in noises: what is right keeps its weight, what is off by more loses it,
    /// also where the noise is a twentieth of a pixel. Raised: a few wrong observations of exact
    /// features bend the model as a whole (a flight over a plane, without EXIF, by 16 % of its
    /// focal length); lowered: right ones lose weight. 0: the loss stays as it is. Scale of an
    /// M-estimator: Huber, Robust Statistics, 1981, ch. 7; the number is ours, tuned on castle-P19
    /// and a rendered flight, judged on the other scenes (docs/accuracy.md).
    double loss = 0.0;
    /// Error of an observation that is kept at most, in noises. Raised: as above; lowered: large
    /// features, which are found less exactly, are lost. 0: the bound stays as it is. Ours: of 12
    /// and 30 the one that keeps what brighton needs (docs/notebook/2026-11-25-noise.md).
    double max_error = 0.0;
    /// The loss is not narrower than this [px], and the bound on errors not below. Lowered: what
    /// rendered features are off by, and large features are always, counts as wrong; raised: exact
    /// features are not made use of. Ours; not tuned: nothing is found more exactly than the first,
    /// and large features are off by as much as the second.
    double min_loss_px = 0.05;
    double min_max_error_px = 1.0;
};

}  // namespace psfm
