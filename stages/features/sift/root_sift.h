// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace psfm {

/// RootSIFT (Arandjelovic & Zisserman, CVPR 2012) as bytes: round(512 * sqrt(sift_i / |sift|_1)),
/// at most 255. Euclidean distances between the results compare the square roots of the SIFT
/// histograms (Hellinger kernel); the L2 norm is 512 but for rounding and clamping.
/// @param sift, root_sift  of equal size; sift holds values >= 0. All zero gives all zero.
/// Thread-safe.
void write_root_sift(std::span<const float> sift, std::span<std::uint8_t> root_sift);

}  // namespace psfm
