// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/observation_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "stages/algorithms/math/median.h"
#include "stages/reconstruction/adjust/bundle_adjustment.h"

namespace psfm {
namespace {

/// Mathematics: the median length of a vector of two normal coordinates (Rayleigh), over their
/// standard deviation: sqrt(2 ln 2).
constexpr double kMedianLength = 1.1774100225154747;

}  // namespace

double observation_noise(const WorkingModel& model, const AdjustmentOptions& options) {
    std::vector<double> lengths;
    for (const WorkingModel::Point& point : model.points()) {
        if (point.track.size() < 2) continue;
        const double measured = 2.0 * static_cast<double>(point.track.size());
        const double freedom = measured / (measured - 3.0);
        for (const WorkingModel::Feature& feature : point.track) {
            const double sigma = observation_sigma(model.keypoint(feature), options);
            const double squared = model.squared_error(feature, point.position) / (sigma * sigma);
            if (std::isfinite(squared)) lengths.push_back(squared * freedom);
        }
    }
    if (lengths.empty()) return 0.0;
    return std::sqrt(upper_median(std::move(lengths))) / kMedianLength;
}

AdjustmentOptions fitted_to_noise(const WorkingModel& model, const AdjustmentOptions& options,
                                  const NoiseBounds& bounds) {
    AdjustmentOptions fitted = options;
    if (bounds.loss == 0.0) return fitted;
    const double width =
        std::max(bounds.min_loss_px, bounds.loss * observation_noise(model, options));
    fitted.loss_scale_px = std::min(options.loss_scale_px, width);
    return fitted;
}

double max_error_by_noise(const WorkingModel& model, const AdjustmentOptions& options,
                          const NoiseBounds& bounds, double max_error_px) {
    if (bounds.max_error == 0.0) return max_error_px;
    const double bound = bounds.max_error * observation_noise(model, options);
    return std::min(max_error_px, std::max(bounds.min_max_error_px, bound));
}

}  // namespace psfm
