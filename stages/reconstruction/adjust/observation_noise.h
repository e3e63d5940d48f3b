// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stages/algorithms/adjustment/adjustment_options.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// Standard deviation of a coordinate of a model's observations, relative to their own
/// (observation_sigma) [px]: from the median of the errors, each with the degrees of freedom that
/// its point has used up. Wrong observations, up to half of them, do not move it. 0: no
/// observations.
double observation_noise(const WorkingModel& model, const AdjustmentOptions& options);

/// The same adjustment, its loss narrowed to what the noise allows; never wider than before.
AdjustmentOptions fitted_to_noise(const WorkingModel& model, const AdjustmentOptions& options,
                                  const NoiseBounds& bounds);

/// The same for the error of observations that are kept [px]; never above max_error_px.
double max_error_by_noise(const WorkingModel& model, const AdjustmentOptions& options,
                          const NoiseBounds& bounds, double max_error_px);

}  // namespace psfm
