// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

namespace psfm {

/// Sorts, and keeps one of equal ones.
template <typename T>
void sort_unique(std::vector<T>& values) {
    std::ranges::sort(values);
    // std::unique: clang 14, which the fuzzers are built with, has no std::ranges::unique.
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace psfm
