// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/visibility_pyramid.h"

#include <algorithm>

namespace psfm {

VisibilityPyramid::VisibilityPyramid(std::uint32_t width_px, std::uint32_t height_px)
    : width_(width_px), height_(height_px) {
    for (int level = 0; level < kLevels; ++level) {
        counts_[static_cast<std::size_t>(level)].assign(
            std::size_t{1} << (2U * static_cast<unsigned>(level + 1)), 0);
    }
}

std::size_t VisibilityPyramid::cell(const Eigen::Vector2d& pixel, int level) const {
    const int side = 2 << level;
    const int column = std::clamp(static_cast<int>(pixel.x() / width_ * side), 0, side - 1);
    const int row = std::clamp(static_cast<int>(pixel.y() / height_ * side), 0, side - 1);
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(side) +
           static_cast<std::size_t>(column);
}

void VisibilityPyramid::add(const Eigen::Vector2d& pixel) {
    ++visible_;
    for (int level = 0; level < kLevels; ++level) {
        std::vector<std::uint32_t>& counts = counts_[static_cast<std::size_t>(level)];
        if (counts[cell(pixel, level)]++ == 0) score_ += counts.size();
    }
}

void VisibilityPyramid::remove(const Eigen::Vector2d& pixel) {
    --visible_;
    for (int level = 0; level < kLevels; ++level) {
        std::vector<std::uint32_t>& counts = counts_[static_cast<std::size_t>(level)];
        if (--counts[cell(pixel, level)] == 0) score_ -= counts.size();
    }
}

}  // namespace psfm
