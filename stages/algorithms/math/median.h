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

}  // namespace psfm
