// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

namespace psfm {

/// Format: Descriptors::kSize, repeated so that code compiled for one processor includes no Eigen.
inline constexpr std::size_t kDescriptorBytes = 128;
/// Format: columns that lie side by side in the packed form: one 512-bit register of 32-bit sums.
inline constexpr std::size_t kStripColumns = 16;
/// Format: strips are padded with empty ones to a multiple of this, the widest register tile of any
/// kernel.
inline constexpr std::size_t kStripGroup = 3;

/// 16 columns: 32 times (4 bytes of each of the 16), every byte minus 128 as a signed number.
struct alignas(64) Strip {
    std::int8_t bytes[kStripColumns * kDescriptorBytes];
};

/// One 32-bit number for each column of a strip.
struct alignas(64) StripKeys {
    std::int32_t lane[kStripColumns];
};

/// Smallest and second smallest key of each lane.
struct alignas(64) LaneMinima {
    std::int32_t best[kStripColumns];
    std::int32_t second[kStripColumns];
};

constexpr std::size_t strip_count(std::size_t columns) {
    constexpr std::size_t kGroupColumns = kStripColumns * kStripGroup;
    return (columns + kGroupColumns - 1) / kGroupColumns * kStripGroup;
}

/// Squared distance of a neighbour that does not exist.
inline constexpr std::int32_t kNoDistance = std::numeric_limits<std::int32_t>::max();

/// Both sides of a product of all rows with all columns. Views; the caller keeps the arrays alive.
struct DotKernelInput {
    const std::uint8_t* rows = nullptr;       ///< 128 bytes each, one descriptor after another
    const std::int32_t* row_norms = nullptr;  ///< squared Euclidean norms
    const std::int32_t* row_sums = nullptr;   ///< sums of the 128 bytes
    /// The numbers of the rows that take part, ascending; null: they are 0, 1, ... All arrays with
    /// one entry a row are looked up by these numbers.
    const std::uint32_t* row_numbers = nullptr;
    std::size_t row_count = 0;  ///< that take part
    const Strip* strips =
        nullptr;  ///< strip_count(column_count); columns past the end are all zero
    const std::int32_t* column_norms = nullptr;
    std::size_t column_count = 0;
    std::size_t first_column = 0;  ///< the number of the first column among all that rows may meet
};

/// The nearest neighbour of each descriptor of one side, and the distance to the second nearest.
struct NearestTwo {
    std::int32_t* best = nullptr;  ///< squared distance minus the descriptor's own squared norm
    std::int32_t* second =
        nullptr;  ///< likewise; kNoDistance when the other side has one descriptor
    std::uint32_t* index = nullptr;  ///< of the nearest; the lowest one among equals
};

/// What a kernel writes, on top of what is there: several products of the same rows with different
/// columns, or the other way round, leave the nearest of all. Arrays are the caller's: kernels are
/// compiled for processors that may not be there, and must not instantiate library templates that
/// the linker could then use everywhere.
struct DotKernelOutput {
    NearestTwo of_rows;                   ///< by number of the row; preset to kNoDistance
    NearestTwo of_columns;                ///< column_count entries, likewise
    StripKeys* column_keys = nullptr;     ///< scratch: one a strip
    LaneMinima* column_minima = nullptr;  ///< scratch: one a strip
};

/// Nearest and second nearest neighbours in both directions. All kernels write the same bits.
/// Thread-safe for distinct outputs.
using DotKernel = void (*)(const DotKernelInput&, const DotKernelOutput&);

/// Format: what the keys of a row are counted in: squared distances times this.
inline constexpr std::int32_t kKeyUnit = 256;

/// The keys of all columns for each row that takes part, strip_count(column_count) strips a row,
/// one row after another: kKeyUnit times the squared distance without the row's own squared norm,
/// and less than kKeyUnit more; INT32_MAX past the last column. REQUIRES: at most 255 strips.
using DistanceKernel = void (*)(const DotKernelInput&, StripKeys* keys);

void dot_kernel_portable(const DotKernelInput& input, const DotKernelOutput& output);
void dot_kernel_avx2(const DotKernelInput& input, const DotKernelOutput& output);
void dot_kernel_avx_vnni(const DotKernelInput& input, const DotKernelOutput& output);
void dot_kernel_avx512_vnni(const DotKernelInput& input, const DotKernelOutput& output);

void distance_kernel_portable(const DotKernelInput& input, StripKeys* keys);
void distance_kernel_avx2(const DotKernelInput& input, StripKeys* keys);
void distance_kernel_avx_vnni(const DotKernelInput& input, StripKeys* keys);
void distance_kernel_avx512_vnni(const DotKernelInput& input, StripKeys* keys);

/// Sum of the bytes, and of their squares, of each of `count` descriptors.
using RowSumsKernel = void (*)(const std::uint8_t* rows, std::size_t count, std::int32_t* sums,
                               std::int32_t* norms);

void row_sums_portable(const std::uint8_t* rows, std::size_t count, std::int32_t* sums,
                       std::int32_t* norms);
void row_sums_avx2(const std::uint8_t* rows, std::size_t count, std::int32_t* sums,
                   std::int32_t* norms);
void row_sums_avx512_vnni(const std::uint8_t* rows, std::size_t count, std::int32_t* sums,
                          std::int32_t* norms);

struct NamedDotKernel {
    std::string_view name;
    DotKernel kernel;
    DistanceKernel distances;
    RowSumsKernel row_sums;
};

/// The kernels that this processor and operating system can run, fastest first; never empty.
std::vector<NamedDotKernel> available_dot_kernels();

}  // namespace psfm
