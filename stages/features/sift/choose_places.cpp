// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/sift/choose_places.h"

#include <algorithm>
#include <tuple>

namespace psfm {
namespace {

auto key(const SiftPlace& place) {
    return std::tuple(-place.scale, place.y, place.x);
}

}  // namespace

bool comes_before(const SiftPlace& a, const SiftPlace& b) {
    return key(a) < key(b);
}

void choose_places(const SiftOptions& options, std::vector<SiftPlace>& places) {
    std::ranges::stable_sort(places, comes_before);
    // std::unique: clang 14, which the fuzzers are built with, has no std::ranges::unique.
    const auto rest =
        std::unique(places.begin(), places.end(),
                    [](const SiftPlace& a, const SiftPlace& b) { return key(a) == key(b); });
    places.erase(rest, places.end());
    if (places.size() > options.max_features) places.resize(options.max_features);
}

}  // namespace psfm
