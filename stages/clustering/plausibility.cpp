// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/plausibility.h"

#include <algorithm>
#include <cmath>

namespace psfm {

Result<void> validate(const PlausibilityOptions& options) {
    const auto invalid = [](const char* what) {
        return Error{ErrorCode::kInvalidArgument, std::string("plausibility: ") + what};
    };
    if (!(options.max_plausibility > 0.0)) return invalid("max_plausibility is not positive");
    for (const ExpectedDensity& expected : {options.shared, options.core}) {
        if (!(expected.floor > 0.0 && expected.at_zero >= expected.floor &&
              expected.decay_deg > 0.0))
            return invalid("an expected density must be positive and not below its floor");
    }
    return {};
}

double plausibility(const TwoViewGeometry& geometry, const PlausibilityOptions& options) {
    if (geometry.match_density <= 0.0) return options.max_plausibility;
    const auto reached = [&](double density, const ExpectedDensity& expected) {
        const double fallen =
            expected.at_zero * std::exp(-geometry.median_angle_deg / expected.decay_deg);
        return density / std::max(expected.floor, fallen);
    };
    return std::min(options.max_plausibility,
                    std::max(reached(geometry.match_density, options.shared),
                             reached(geometry.core_density, options.core)));
}

}  // namespace psfm
