// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace psfm {

/// Which tiles of a symmetric matrix's lower triangle are not empty. A matrix consists of blocks,
/// one a camera; a tile is as wide as some successive blocks, and cuts none.
class TilePattern {
  public:
    TilePattern() = default;
    /// Diagonal tiles only. @param starts  first column of each block, ascending from 0
    TilePattern(std::span<const std::size_t> starts, std::size_t columns);

    std::uint32_t tiles() const { return static_cast<std::uint32_t>(first_.size() - 1); }
    std::size_t columns() const { return first_.back(); }
    std::uint32_t tile_of(std::size_t column) const { return tile_of_[column]; }
    /// First column of a tile; of tiles(): how many columns there are.
    std::size_t first_of(std::uint32_t tile) const { return first_[tile]; }
    bool has(std::uint32_t row, std::uint32_t column) const { return has_[place(row, column)]; }

    /// Blocks in these tiles depend on each other. @param tiles  ascending
    void couple(std::span<const std::uint32_t> tiles);
    /// Adds the tiles that a Cholesky factorisation fills.
    void fill();
    /// Memory of a matrix with this pattern.
    std::size_t bytes() const;

    /// Of tile (row, column) among all of the lower triangle. REQUIRES: row >= column
    static std::size_t place(std::uint32_t row, std::uint32_t column) {
        return std::size_t{row} * (row + 1) / 2 + column;
    }

  private:
    std::vector<std::size_t> first_ = {0};
    std::vector<std::uint32_t> tile_of_;  // by column
    std::vector<bool> has_;
};

/// A symmetric positive definite matrix, of whose lower triangle the tiles of a pattern are stored,
/// and its Cholesky factorisation in place. Threads may write different columns at a time.
class TiledMatrix {
  public:
    TiledMatrix() = default;
    /// Zero, with room for what factorisation fills.
    explicit TiledMatrix(TilePattern pattern);

    template <int kRows, int kColumns>
    using Part = Eigen::Map<Eigen::Matrix<double, kRows, kColumns>, 0, Eigen::OuterStride<>>;

    /// Entries from (row, column) on. REQUIRES: row >= column, of one tile of the pattern
    template <int kRows, int kColumns>
    Part<kRows, kColumns> part(std::size_t row, std::size_t column, Eigen::Index rows = kRows,
                               Eigen::Index columns = kColumns) {
        const std::uint32_t low = pattern_.tile_of(row);
        const std::uint32_t left = pattern_.tile_of(column);
        const auto stride = static_cast<Eigen::Index>(height(low));
        double* tile = &values_[offsets_[TilePattern::place(low, left)]];
        const std::size_t within =
            (column - pattern_.first_of(left)) * height(low) + (row - pattern_.first_of(low));
        return {tile + within, rows, columns, Eigen::OuterStride<>(stride)};
    }
    double& at(std::size_t row, std::size_t column) { return part<1, 1>(row, column)(0, 0); }

    void set_zero();
    /// The matrix becomes L of L L', tile by tile, with TBB's threads where they are free. The
    /// result does not depend on the threads, but its last digits do on the processor, whose
    /// instructions OpenBLAS chooses.
    /// @return false when it is not positive definite
    bool factorize();
    /// Solves L L' x = b in place. REQUIRES: factorize has succeeded
    void solve(Eigen::VectorXd& right_side) const;

  private:
    using Tile = Eigen::Map<Eigen::MatrixXd>;
    using ConstTile = Eigen::Map<const Eigen::MatrixXd>;
    std::size_t height(std::uint32_t tile) const {
        return pattern_.first_of(tile + 1) - pattern_.first_of(tile);
    }
    Tile tile(std::uint32_t row, std::uint32_t column);
    ConstTile tile(std::uint32_t row, std::uint32_t column) const;

    TilePattern pattern_;
    std::vector<std::size_t> offsets_;               // by place; unset where the tile is empty
    std::vector<std::vector<std::uint32_t>> below_;  // not empty in each column, ascending
    std::vector<double> values_;
};

}  // namespace psfm
