// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace psfm {

/// The value in the middle, by what `projection` says of each; of an even number the upper one of
/// the two in the middle, so that it is always one of the values. REQUIRES: not empty
template <typename T, typename Projection = std::identity>
T upper_median(std::vector<T> values, Projection projection = {}) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle, {}, projection);
    return std::move(*middle);
}

/// The upper median, or `if_none` of no values.
template <typename T>
T upper_median_or(std::vector<T> values, T if_none) {
    return values.empty() ? std::move(if_none) : upper_median(std::move(values));
}

/// The median as statistics have it: of an even number of values the mean of the lower and the
/// upper one; `if_none` of no values.
inline double median_or(std::vector<double> values, double if_none) {
    if (values.empty()) return if_none;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    if (values.size() % 2 == 1) return *middle;
    const double lower = *std::max_element(values.begin(), middle);
    return 0.5 * (lower + *middle);
}

}  // namespace psfm
