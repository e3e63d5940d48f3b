// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>

namespace psfm {

// Mathematics: a product with a factor and the functions differ in the last bit for some angles;
// both are here, so that a caller who had the one keeps it, and results stay what they are.
inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

constexpr double radians_from_degrees(double degrees) {
    return degrees * std::numbers::pi / 180.0;
}
constexpr double degrees_from_radians(double radians) {
    return radians * 180.0 / std::numbers::pi;
}

}  // namespace psfm
