// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/adjustment/tiled_matrix.h"

#include <cblas.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

#include "stages/algorithms/math/in_parallel.h"
#include "stages/algorithms/math/one_blas_thread.h"

namespace psfm {
namespace {

/// Guard: columns of a tile at most. Raised: products of tiles come nearer to the processor's peak;
/// lowered: less of what is zero is computed. Ours: dense systems take as long with 96 as with 192,
/// those of streets four fifths.
constexpr std::size_t kTileColumns = 96;

using Tile = Eigen::Map<Eigen::MatrixXd>;

blasint in_blas(Eigen::Index number) {
    return static_cast<blasint>(number);
}

/// rows := rows * inverse(corner'), of whose lower triangle corner consists.
void solve_rows(const Tile& corner, Tile rows) {
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit,
                in_blas(rows.rows()), in_blas(rows.cols()), 1.0, corner.data(),
                in_blas(corner.rows()), rows.data(), in_blas(rows.rows()));
}

/// target := target - a * b'.
void subtract_product(const Tile& a, const Tile& b, Tile target) {
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, in_blas(a.rows()), in_blas(b.rows()),
                in_blas(a.cols()), -1.0, a.data(), in_blas(a.rows()), b.data(), in_blas(b.rows()),
                1.0, target.data(), in_blas(target.rows()));
}

/// The lower triangle of target - a * a'.
void subtract_square(const Tile& a, Tile target) {
    cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, in_blas(a.rows()), in_blas(a.cols()), -1.0,
                a.data(), in_blas(a.rows()), 1.0, target.data(), in_blas(target.rows()));
}

}  // namespace

TilePattern::TilePattern(std::span<const std::size_t> starts, std::size_t columns) {
    for (std::size_t block = 0; block < starts.size(); ++block) {
        const std::size_t end = block + 1 < starts.size() ? starts[block + 1] : columns;
        if (end - first_.back() > kTileColumns && starts[block] > first_.back())
            first_.push_back(starts[block]);
    }
    if (columns > first_.back()) first_.push_back(columns);
    tile_of_.resize(columns);
    for (std::uint32_t tile = 0; tile < tiles(); ++tile) {
        std::fill(tile_of_.begin() + static_cast<std::ptrdiff_t>(first_[tile]),
                  tile_of_.begin() + static_cast<std::ptrdiff_t>(first_[tile + 1]), tile);
    }
    has_.resize(place(tiles(), 0), false);
    for (std::uint32_t tile = 0; tile < tiles(); ++tile) has_[place(tile, tile)] = true;
}

void TilePattern::couple(std::span<const std::uint32_t> tiles) {
    for (std::size_t low = 0; low < tiles.size(); ++low) {
        for (std::size_t left = 0; left < low; ++left) has_[place(tiles[low], tiles[left])] = true;
    }
}

void TilePattern::fill() {
    std::vector<std::uint32_t> below;
    for (std::uint32_t column = 0; column < tiles(); ++column) {
        below.clear();
        for (std::uint32_t row = column + 1; row < tiles(); ++row) {
            if (has(row, column)) below.push_back(row);
        }
        couple(below);
    }
}

std::size_t TilePattern::bytes() const {
    std::size_t entries = 0;
    for (std::uint32_t row = 0; row < tiles(); ++row) {
        for (std::uint32_t column = 0; column <= row; ++column) {
            if (has(row, column))
                entries += (first_[row + 1] - first_[row]) * (first_[column + 1] - first_[column]);
        }
    }
    return entries * sizeof(double);
}

TiledMatrix::TiledMatrix(TilePattern pattern) : pattern_(std::move(pattern)) {
    pattern_.fill();
    offsets_.resize(TilePattern::place(pattern_.tiles(), 0), 0);
    below_.resize(pattern_.tiles());
    std::size_t size = 0;
    for (std::uint32_t column = 0; column < pattern_.tiles(); ++column) {
        for (std::uint32_t row = column; row < pattern_.tiles(); ++row) {
            if (!pattern_.has(row, column)) continue;
            if (row > column) below_[column].push_back(row);
            offsets_[TilePattern::place(row, column)] = size;
            size += height(row) * height(column);
        }
    }
    values_.resize(size, 0.0);
}

TiledMatrix::Tile TiledMatrix::tile(std::uint32_t row, std::uint32_t column) {
    return {&values_[offsets_[TilePattern::place(row, column)]],
            static_cast<Eigen::Index>(height(row)), static_cast<Eigen::Index>(height(column))};
}

TiledMatrix::ConstTile TiledMatrix::tile(std::uint32_t row, std::uint32_t column) const {
    return {&values_[offsets_[TilePattern::place(row, column)]],
            static_cast<Eigen::Index>(height(row)), static_cast<Eigen::Index>(height(column))};
}

void TiledMatrix::set_zero() {
    std::ranges::fill(values_, 0.0);
}

bool TiledMatrix::factorize() {
    keep_blas_on_one_thread();
    for (std::uint32_t column = 0; column < pattern_.tiles(); ++column) {
        const Tile corner = tile(column, column);
        Eigen::Ref<Eigen::MatrixXd> in_place(corner);
        const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(in_place);
        if (factor.info() != Eigen::Success) return false;
        const std::vector<std::uint32_t>& below = below_[column];
        in_parallel(below.size(),
                    [&](std::size_t i) { solve_rows(corner, tile(below[i], column)); });
        in_parallel(below.size() * below.size(), [&](std::size_t pair) {
            const std::uint32_t low = below[pair / below.size()];
            const std::uint32_t left = below[pair % below.size()];
            if (left > low) return;
            if (low == left) {
                subtract_square(tile(low, column), tile(low, low));
            } else {
                subtract_product(tile(low, column), tile(left, column), tile(low, left));
            }
        });
    }
    return true;
}

void TiledMatrix::solve(Eigen::VectorXd& right_side) const {
    const auto part_of = [&](std::uint32_t at) {
        return right_side.segment(static_cast<Eigen::Index>(pattern_.first_of(at)),
                                  static_cast<Eigen::Index>(height(at)));
    };
    for (std::uint32_t column = 0; column < pattern_.tiles(); ++column) {
        auto solved = part_of(column);
        const ConstTile corner = tile(column, column);
        corner.triangularView<Eigen::Lower>().solveInPlace(solved);
        for (const std::uint32_t row : below_[column])
            part_of(row).noalias() -= tile(row, column) * solved;
    }
    for (std::uint32_t column = pattern_.tiles(); column-- > 0;) {
        auto solved = part_of(column);
        for (const std::uint32_t row : below_[column])
            solved.noalias() -= tile(row, column).transpose() * part_of(row);
        const ConstTile corner = tile(column, column);
        corner.triangularView<Eigen::Lower>().transpose().solveInPlace(solved);
    }
}

}  // namespace psfm
