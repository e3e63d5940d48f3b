// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stages/reconstruction/bundle_adjustment.h"

namespace psfm {

/// Standard deviation of a coordinate of a model's observations, relative to their own
/// (observation_sigma) [px]: from the median of the errors, each with the degrees of freedom that
/// its point has used up. Wrong observations, up to half of them, do not move it. 0: no observations.
double observation_noise(const WorkingModel& model, const AdjustmentOptions& options);

/// How far what is right may be off, by a model's noise.
struct NoiseBounds {
    /// Width of the loss, in noises: what is right keeps its weight, what is off by more loses it,
    /// also where the noise is a twentieth of a pixel. Raised: a few wrong observations of exact
    /// features bend the model as a whole (a flight over a plane, without EXIF, by 16 % of its focal
    /// length); lowered: right ones lose weight. 0: the loss stays as it is. Scale of an
    /// M-estimator: Huber, Robust Statistics, 1981, ch. 7; the number is ours, tuned on castle-P19
    /// and a rendered flight, judged on the other scenes (docs/accuracy.md).
    double loss = 0.0;
    /// Error of an observation that is kept at most, in noises. Raised: as above; lowered: large
    /// features, which are found less exactly, are lost. 0: the bound stays as it is. Ours, tuned
    /// as above.
    double max_error = 0.0;
};

/// The same adjustment, its loss narrowed to what the noise allows; never wider than before.
AdjustmentOptions fitted_to_noise(const WorkingModel& model, const AdjustmentOptions& options,
                                  const NoiseBounds& bounds);

/// The same for the error of observations that are kept [px]; never above max_error_px.
double max_error_by_noise(const WorkingModel& model, const AdjustmentOptions& options,
                          const NoiseBounds& bounds, double max_error_px);

}  // namespace psfm
