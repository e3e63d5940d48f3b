// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/sift/root_sift.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace psfm {

void write_root_sift(std::span<const float> sift, std::span<std::uint8_t> root_sift) {
    assert(sift.size() == root_sift.size());
    float sum = 0.F;
    for (const float value : sift) sum += value;
    const float factor = sum > 0.F ? 512.F * 512.F / sum : 0.F;
    for (std::size_t i = 0; i < sift.size(); ++i) {
        const float value = std::sqrt(sift[i] * factor) + 0.5F;
        root_sift[i] = static_cast<std::uint8_t>(std::min(value, 255.F));
    }
}

}  // namespace psfm
