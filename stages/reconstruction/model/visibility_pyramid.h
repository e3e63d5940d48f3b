// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace psfm {

/// Counts points over an image and how evenly they lie: grids of 2x2 to 32x32 cells, where an
/// occupied cell of a grid with 2^l cells a side scores 4^l. The idea of a multi-resolution score
/// is COLMAP's (Schönberger and Frahm, CVPR 2016, sec. 4.2).
class VisibilityPyramid {
  public:
    VisibilityPyramid() = default;
    VisibilityPyramid(std::uint32_t width_px, std::uint32_t height_px);

    void add(const Eigen::Vector2d& pixel);
    void remove(const Eigen::Vector2d& pixel);  ///< REQUIRES: was added

    std::uint32_t visible() const { return visible_; }
    std::uint64_t score() const { return score_; }

  private:
    static constexpr int kLevels = 5;  // Mathematics: of the score; COLMAP 3.8 has six
    std::size_t cell(const Eigen::Vector2d& pixel, int level) const;

    double width_ = 1.0;
    double height_ = 1.0;
    std::array<std::vector<std::uint32_t>, kLevels> counts_;
    std::uint32_t visible_ = 0;
    std::uint64_t score_ = 0;
};

}  // namespace psfm
