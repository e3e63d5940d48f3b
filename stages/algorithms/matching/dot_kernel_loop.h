// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The blocked loop shared by all dot kernels. Included only by dot_kernel_*.cpp, each of which
// compiles it for its own instruction set: everything here has internal linkage, so that no
// function compiled for one processor can be linked into the path of another. For the same reason
// no library template is used.
//
// Ours; the register tile over a packed operand follows Goto & van de Geijn, "Anatomy of
// high-performance matrix multiplication", ACM TOMS 2008. What is different here: the product is
// never stored. Each tile of sums is turned into keys and folded into running minima while it is
// still in registers.
//
// Keys. For row i the nearest column minimises n_j - 2 a_i.b_j (its own norm is constant), and for
// column j the nearest row minimises m_i - 2 a_i.b_j. Both lie in (-2^23, 2^23) for any bytes, so 8
// bits are left in an int32 for "where": key = value * 256 + position. The smaller key is then the
// nearer neighbour, and the earlier one among equals, with plain integer minima. Positions count
// within a block (256 rows; 255 strips of columns), and blocks are folded into the full result.
#pragma once

#include <cstring>

#include "stages/algorithms/matching/dot_kernel.h"

namespace psfm {
namespace {

/// Guard: positions within a block fit a key's bits, and what is in use the caches.
constexpr std::size_t kBlockStrips =
    255;  ///< of one block of columns; fits 8 bits, multiple of kStripGroup
constexpr std::size_t kBlockRows = 256;
constexpr std::size_t kSliceRows =
    32;  ///< rows whose minima stay in the L1 cache while columns pass by
static_assert(kBlockStrips % kStripGroup == 0 && kBlockRows % kSliceRows == 0);

/// Calls body(Index<0>), …, body(Index<kCount - 1>). Written out while parsing, not left to the
/// optimiser: GCC keeps an array of sums in registers only when no loop ever indexed it (measured:
/// 3 times faster).
template <std::size_t kIndex>
struct Index {
    constexpr operator std::size_t() const { return kIndex; }  // NOLINT: implicit by design
};
template <std::size_t kCount, typename Body>
__attribute__((always_inline)) inline void unrolled(const Body& body) {
    if constexpr (kCount > 0) {
        unrolled<kCount - 1>(body);
        body(Index<kCount - 1>{});
    }
}
#define PSFM_INLINE __attribute__((always_inline))

template <typename T>
inline T smaller(T a, T b) {
    return b < a ? b : a;
}

inline std::int32_t load_four(const std::uint8_t* bytes) {
    std::int32_t four = 0;
    std::memcpy(&four, bytes, sizeof(four));
    return four;
}

/// Folds the nearest and second nearest of one block into those of all blocks before it.
inline void fold(const NearestTwo& into, std::size_t at, std::int32_t best, std::size_t where,
                 std::int32_t second) {
    if (best < into.best[at]) {  // strict: earlier blocks win among equals
        into.second[at] = smaller(into.best[at], second);
        into.best[at] = best;
        into.index[at] = static_cast<std::uint32_t>(where);
    } else {
        into.second[at] = smaller(into.second[at], best);
    }
}

inline std::int32_t value_of(std::int32_t key) {
    return key == kNoDistance ? kNoDistance : key >> 8;
}
inline std::size_t position_of(std::int32_t key) {
    return static_cast<std::uint32_t>(key) & 255U;
}

inline void clear(LaneMinima& minima) {
    for (std::size_t lane = 0; lane < kStripColumns; ++lane) {
        minima.best[lane] = kNoDistance;
        minima.second[lane] = kNoDistance;
    }
}

/// The lowest two keys of one row over all lanes.
struct LowestTwo {
    std::int32_t best;
    std::int32_t second;
    std::size_t lane;  ///< of the best; the first, that is of the first column, among equal keys
};

/// Isa::Vector holds kLanes sums; Isa::Tile is a kTileRows x kTileStrips tile of strips, each in
/// kStripColumns / kLanes vectors. Isa::add_products(rows, strips, k, sums) adds the products of
/// bytes k … k + 3, where rows points at byte k of the tile's first row. Isa::lowest_two(lanes) is
/// asked once for each row and cell: with few columns one lane after the other would take half as
/// long as their products.
template <typename Isa>
class DotLoop {
  public:
    DotLoop(const DotKernelInput& input, const DotKernelOutput& output)
        : in_(input), out_(output), strips_(strip_count(input.column_count)) {}

    void run() {
        for (std::size_t j = 0; j < strips_ * kStripColumns; ++j)
            out_.column_keys[j / kStripColumns].lane[j % kStripColumns] = column_key(j);
        for (std::size_t row = 0; row < in_.row_count; row += kBlockRows) {
            const std::size_t row_end = smaller(row + kBlockRows, in_.row_count);
            for (std::size_t strip = 0; strip < strips_; ++strip) clear(out_.column_minima[strip]);
            for (std::size_t strip = 0; strip < strips_; strip += kBlockStrips) {
                const std::size_t strip_end = smaller(strip + kBlockStrips, strips_);
                for (std::size_t slice = row; slice < row_end; slice += kSliceRows) {
                    run_slice(row, slice, smaller(slice + kSliceRows, row_end), strip, strip_end);
                }
            }
            fold_columns(row);
        }
    }

    /// The keys that run() takes the minima of, of each row one after another.
    void write_keys(StripKeys* keys) {
        StripKeys column_keys[kBlockStrips];
        for (std::size_t j = 0; j < strips_ * kStripColumns; ++j)
            column_keys[j / kStripColumns].lane[j % kStripColumns] = column_key(j);
        for (std::size_t begin = 0; begin < in_.row_count; begin += kSliceRows) {
            const std::size_t end = smaller(begin + kSliceRows, in_.row_count);
            Slice slice;  // NOLINT: load_slice() writes all that is read
            load_slice(begin, begin, end, slice);
            for (std::size_t strip = 0; strip < strips_; strip += Isa::kTileStrips) {
                for (std::size_t r = 0; r < slice.rows_used; r += Isa::kTileRows) {
                    write_tile(slice, r, column_keys, strip, keys + (begin + r) * strips_,
                               end - begin - r);
                }
            }
        }
    }

  private:
    using Vector = typename Isa::Vector;
    static constexpr std::size_t kParts = kStripColumns / Isa::kLanes;
    static constexpr std::size_t kTileVectors = Isa::kTileStrips * kParts;

    /// Rows side by side, as tiles read them, in whole tiles. Those past the end are all zero, so
    /// their sums are zero and their keys stay at kNoDistance.
    struct Slice {
        alignas(64) std::uint8_t rows[kSliceRows * kDescriptorBytes];
        std::int32_t row_keys[kSliceRows];
        std::int32_t row_offsets[kSliceRows];
        std::size_t rows_used;
    };

    std::size_t number_of(std::size_t row) const {
        return in_.row_numbers != nullptr ? in_.row_numbers[row] : row;
    }

    std::int32_t column_key(std::size_t j) const {
        const std::size_t position = j / kStripColumns % kBlockStrips;
        return j < in_.column_count
                   ? in_.column_norms[j] * kKeyUnit + static_cast<std::int32_t>(position)
                   : kNoDistance;
    }

    /// The rows [begin, end), at most kSliceRows, whose positions count from `block`.
    void load_slice(std::size_t block, std::size_t begin, std::size_t end, Slice& slice) const {
        slice.rows_used = (end - begin + Isa::kTileRows - 1) / Isa::kTileRows * Isa::kTileRows;
        for (std::size_t r = end - begin; r < slice.rows_used; ++r) {
            std::memset(slice.rows + r * kDescriptorBytes, 0, kDescriptorBytes);
            slice.row_keys[r] = kNoDistance;
            slice.row_offsets[r] = 0;
        }
        for (std::size_t r = 0; r < end - begin; ++r) {
            const std::size_t i = number_of(begin + r);
            std::memcpy(slice.rows + r * kDescriptorBytes, in_.rows + i * kDescriptorBytes,
                        kDescriptorBytes);
            slice.row_keys[r] =
                in_.row_norms[i] * kKeyUnit + static_cast<std::int32_t>(begin + r - block);
            slice.row_offsets[r] = 128 * in_.row_sums[i];
        }
    }

    /// Rows [begin, end), at most kSliceRows, of the row block that starts at `block`, with the
    /// strips [strip_begin, strip_end) of one column block.
    void run_slice(std::size_t block, std::size_t begin, std::size_t end, std::size_t strip_begin,
                   std::size_t strip_end) {
        Slice slice;  // NOLINT: load_slice() writes all that is read
        load_slice(block, begin, end, slice);
        LaneMinima row_minima[kSliceRows];
        for (LaneMinima& minima : row_minima) clear(minima);
        for (std::size_t strip = strip_begin; strip < strip_end; strip += Isa::kTileStrips) {
            for (std::size_t r = 0; r < slice.rows_used; r += Isa::kTileRows) {
                run_tile(slice, r, row_minima + r, strip);
            }
        }
        for (std::size_t r = 0; r < end - begin; ++r) {
            const LowestTwo lowest = Isa::lowest_two(row_minima[r]);
            const std::size_t strip = strip_begin + position_of(lowest.best);
            fold(out_.of_rows, number_of(begin + r), value_of(lowest.best),
                 in_.first_column + strip * kStripColumns + lowest.lane, value_of(lowest.second));
        }
    }

    using Sums = Vector[Isa::kTileRows][kTileVectors];

    /// 512 times the products of a tile.
    PSFM_INLINE void multiply(const Slice& slice, std::size_t row, std::size_t strip, Sums& sums) {
        unrolled<Isa::kTileRows>([&](auto r) PSFM_INLINE {
            unrolled<kTileVectors>(
                [&](auto v) PSFM_INLINE { sums[r][v] = Isa::set1(slice.row_offsets[row + r]); });
        });
        const Strip* strips = in_.strips + strip;
        const std::uint8_t* rows = slice.rows + row * kDescriptorBytes;
        for (std::size_t k = 0; k < kDescriptorBytes; k += 4)
            Isa::add_products(rows + k, strips, k, sums);
        unrolled<Isa::kTileRows>([&](auto r) PSFM_INLINE {
            unrolled<kTileVectors>([&](auto v)
                                       PSFM_INLINE { sums[r][v] = Isa::times512(sums[r][v]); });
        });
    }

    PSFM_INLINE void write_tile(const Slice& slice, std::size_t row, const StripKeys* column_keys,
                                std::size_t strip, StripKeys* keys, std::size_t rows_left) {
        Sums sums;
        multiply(slice, row, strip, sums);
        unrolled<Isa::kTileRows>([&](auto r) PSFM_INLINE {
            if (r >= rows_left) return;
            StripKeys* to = keys + r * strips_ + strip;
            unrolled<kTileVectors>([&](auto v) PSFM_INLINE {
                const std::size_t lane = v % kParts * Isa::kLanes;
                const Vector column = Isa::load(column_keys[strip + v / kParts].lane + lane);
                Isa::store(to[v / kParts].lane + lane, Isa::sub(column, sums[r][v]));
            });
        });
    }

    PSFM_INLINE void run_tile(const Slice& slice, std::size_t row, LaneMinima* row_minima,
                              std::size_t strip) {
        Sums sums;
        multiply(slice, row, strip, sums);
        // key = (norm * 256 + position) - 2 * 256 * dot, for both directions.
        const std::int32_t* row_keys = slice.row_keys + row;
        unrolled<kTileVectors>([&](auto v) PSFM_INLINE {
            LaneMinima& minima = out_.column_minima[strip + v / kParts];
            const std::size_t lane = v % kParts * Isa::kLanes;
            Vector best = Isa::load(minima.best + lane);
            Vector second = Isa::load(minima.second + lane);
            unrolled<Isa::kTileRows>([&](auto r) PSFM_INLINE {
                take(Isa::sub(Isa::set1(row_keys[r]), sums[r][v]), best, second);
            });
            Isa::store(minima.best + lane, best);
            Isa::store(minima.second + lane, second);
        });
        unrolled<kParts>([&](auto part) PSFM_INLINE {
            const std::size_t lane = part * Isa::kLanes;
            unrolled<Isa::kTileRows>([&](auto r) PSFM_INLINE {
                Vector best = Isa::load(row_minima[r].best + lane);
                Vector second = Isa::load(row_minima[r].second + lane);
                unrolled<Isa::kTileStrips>([&](auto s) PSFM_INLINE {
                    const Vector keys = Isa::load(out_.column_keys[strip + s].lane + lane);
                    take(Isa::sub(keys, sums[r][s * kParts + part]), best, second);
                });
                Isa::store(row_minima[r].best + lane, best);
                Isa::store(row_minima[r].second + lane, second);
            });
        });
    }

    PSFM_INLINE static void take(Vector key, Vector& best, Vector& second) {
        second = Isa::min(second, Isa::max(best, key));
        best = Isa::min(best, key);
    }

    void fold_columns(std::size_t first_row) {
        for (std::size_t j = 0; j < in_.column_count; ++j) {
            const LaneMinima& minima = out_.column_minima[j / kStripColumns];
            const std::int32_t best = minima.best[j % kStripColumns];
            const std::int32_t second = minima.second[j % kStripColumns];
            fold(out_.of_columns, j, value_of(best), number_of(first_row + position_of(best)),
                 value_of(second));
        }
    }

    const DotKernelInput& in_;
    const DotKernelOutput& out_;
    const std::size_t strips_;
};

}  // namespace
}  // namespace psfm
