// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <ranges>
#include <utility>

namespace psfm {

/// The value that occurs most often, and how often; ties: the smallest. REQUIRES: there are some
template <std::ranges::input_range Values>
std::pair<std::ranges::range_value_t<Values>, std::size_t> most_common(Values&& values) {
    std::map<std::ranges::range_value_t<Values>, std::size_t> counts;
    for (const auto& value : values) ++counts[value];
    return *std::ranges::max_element(counts, {}, [](const auto& entry) { return entry.second; });
}

}  // namespace psfm
