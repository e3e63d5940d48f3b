// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to storage/exchange: what COLMAP's reader and writer of databases share. Layout: COLMAP
// 3.8, src/base/database.{h,cc}; matrices are blobs of little-endian numbers, row after row.

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "graph/result.h"
#include "storage/exchange/files/sqlite_statement.h"

namespace psfm::colmap {

/// Image ids are below this: a pair's key is first * kMaxImages + second with first < second.
inline constexpr std::int64_t kMaxImages = 2147483647;  // Format: COLMAP's, for keys of pairs

/// Persistent numbers of two_view_geometries.config (COLMAP's TwoViewGeometry).
enum class PairConfig : std::uint8_t {
    kUndefined = 0,
    kDegenerate = 1,
    kCalibrated = 2,
    kUncalibrated = 3,
    kPlanar = 4,
    kPanoramic = 5,
    kPlanarOrPanoramic = 6,
    kWatermark = 7,
    kMultiple = 8
};

constexpr std::int64_t pair_key(std::uint32_t first, std::uint32_t second) {
    return first * kMaxImages + second;
}
/// The images of a key, first < second; nothing when it is no pair's.
std::optional<std::pair<std::uint32_t, std::uint32_t>> images_of_pair(std::int64_t key);

template <typename T>
T little_endian_at(std::span<const std::byte> bytes, std::size_t index) {
    assert((index + 1) * sizeof(T) <= bytes.size());
    std::array<std::byte, sizeof(T)> raw{};
    std::memcpy(raw.data(), bytes.data() + index * sizeof(T), sizeof(T));
    if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(raw);
    return std::bit_cast<T>(raw);
}

template <typename T>
void append_little_endian(std::vector<std::byte>& bytes, T value) {
    auto raw = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(raw);
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// A matrix as stored. The bytes are rows * cols of the element size; valid until the next read.
struct Block {
    std::uint32_t rows = 0;
    std::uint32_t cols = 0;
    std::span<const std::byte> bytes;
};

/// Reads the matrices of one table (rows, cols, data), one a key. The size is looked at before
/// SQLite touches the data, so that no more is read than fits.
class BlockReader {
  public:
    /// @param table, key  names in the database, key an integer column
    static Result<BlockReader> make(SqliteConnection& database, const std::string& table,
                                    const std::string& key, std::size_t element_size,
                                    std::initializer_list<std::uint32_t> allowed_cols);

    /// Rows of other columns are passed over, as if they were not there, instead of an error.
    void pass_over_others() { passes_over_others_ = true; }

    /// 0 rows when the table has no such key. @errors kDamaged
    Result<Block> read(std::int64_t key);

  private:
    Error damaged(std::int64_t key, const std::string& problem) const;

    const SqliteConnection* database_ = nullptr;
    std::string table_;
    std::size_t element_size_ = 1;
    std::vector<std::uint32_t> allowed_cols_;
    bool passes_over_others_ = false;
    SqliteStatement shape_;
    SqliteStatement data_;
};

}  // namespace psfm::colmap
