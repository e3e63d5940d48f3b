// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace psfm::synthetic {

enum class Paint {
    kPlaster,  ///< mottled, with stains and signs
    kBricks,   ///< courses of stones, each of its own size and colour
    kPaving,   ///< irregular slabs
};

/// A picture full of detail at all sizes from 2 texels to a metre, that repeats nowhere: 8-bit BGR.
/// Deterministic for equal arguments.
cv::Mat paint_texture(cv::Size texels, double texels_per_metre, Paint paint, std::uint64_t seed);

}  // namespace psfm::synthetic
