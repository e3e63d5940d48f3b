// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/dot_kernel_loop.h"

namespace psfm {
namespace {

/// Plain C++ over arrays; compilers turn the lane loops into whatever the baseline processor has.
struct PortableIsa {
    /// Format: lanes of a strip's columns, and a tile that compilers keep in registers.
    static constexpr std::size_t kLanes = 16;
    static constexpr std::size_t kTileRows = 2;
    static constexpr std::size_t kTileStrips = 1;
    struct Vector {
        std::int32_t lane[kLanes];
    };

    static Vector set1(std::int32_t value) {
        Vector out{};
        for (std::int32_t& x : out.lane) x = value;
        return out;
    }
    static Vector load(const std::int32_t* from) {
        Vector out{};
        std::memcpy(out.lane, from, sizeof(out.lane));
        return out;
    }
    static void store(std::int32_t* to, const Vector& from) {
        std::memcpy(to, from.lane, sizeof(from.lane));
    }
    static Vector min(const Vector& a, const Vector& b) {
        Vector out{};
        for (std::size_t i = 0; i < kLanes; ++i)
            out.lane[i] = a.lane[i] < b.lane[i] ? a.lane[i] : b.lane[i];
        return out;
    }
    static Vector max(const Vector& a, const Vector& b) {
        Vector out{};
        for (std::size_t i = 0; i < kLanes; ++i)
            out.lane[i] = a.lane[i] < b.lane[i] ? b.lane[i] : a.lane[i];
        return out;
    }
    /// Modulo 2^32, as is sub: 512 * dot may exceed an int32, and the difference of the two comes
    /// out right.
    static Vector times512(const Vector& a) {
        Vector out{};
        for (std::size_t i = 0; i < kLanes; ++i) {
            out.lane[i] = static_cast<std::int32_t>(static_cast<std::uint32_t>(a.lane[i]) * 512U);
        }
        return out;
    }
    static Vector sub(const Vector& a, const Vector& b) {
        Vector out{};
        for (std::size_t i = 0; i < kLanes; ++i) {
            out.lane[i] = static_cast<std::int32_t>(static_cast<std::uint32_t>(a.lane[i]) -
                                                    static_cast<std::uint32_t>(b.lane[i]));
        }
        return out;
    }

    static LowestTwo lowest_two(const LaneMinima& lanes) {
        LowestTwo lowest{kNoDistance, kNoDistance, 0};
        for (const std::int32_t candidate : lanes.best)
            lowest.best = smaller(lowest.best, candidate);
        while (lanes.best[lowest.lane] != lowest.best) ++lowest.lane;
        lowest.second = lanes.second[lowest.lane];
        for (std::size_t lane = 0; lane < kStripColumns; ++lane) {
            if (lane != lowest.lane) lowest.second = smaller(lowest.second, lanes.best[lane]);
        }
        return lowest;
    }

    static void add_products(const std::uint8_t* rows, const Strip* strip, std::size_t k,
                             Vector (&sums)[kTileRows][1]) {
        const std::int8_t* columns = strip->bytes + k * kStripColumns;
        for (std::size_t r = 0; r < kTileRows; ++r) {
            const std::uint8_t* row = rows + r * kDescriptorBytes;
            for (std::size_t i = 0; i < kLanes; ++i) {
                for (std::size_t byte = 0; byte < 4; ++byte) {
                    sums[r][0].lane[i] += row[byte] * columns[4 * i + byte];
                }
            }
        }
    }
};

}  // namespace

void dot_kernel_portable(const DotKernelInput& input, const DotKernelOutput& output) {
    DotLoop<PortableIsa>(input, output).run();
}

void distance_kernel_portable(const DotKernelInput& input, StripKeys* keys) {
    DotLoop<PortableIsa>(input, {}).write_keys(keys);
}

void row_sums_portable(const std::uint8_t* rows, std::size_t count, std::int32_t* sums,
                       std::int32_t* norms) {
    for (std::size_t i = 0; i < count; ++i, rows += kDescriptorBytes) {
        sums[i] = 0;
        norms[i] = 0;
        for (std::size_t k = 0; k < kDescriptorBytes; ++k) {
            sums[i] += rows[k];
            norms[i] += rows[k] * rows[k];
        }
    }
}

}  // namespace psfm
