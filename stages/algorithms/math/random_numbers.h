// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace psfm {

/// Random numbers that are the same with every standard library: the bits of std::mt19937_64 are
/// specified, those of the std:: distributions are not. Owned by one computation; not thread-safe.
class RandomNumbers {
  public:
    explicit RandomNumbers(std::uint64_t seed) : engine_(seed) {}

    /// In [0, 1).
    double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1.0p-53; }

    /// Standard normal, by Marsaglia's polar method.
    double normal() {
        while (true) {
            const double x = 2.0 * uniform() - 1.0;
            const double y = 2.0 * uniform() - 1.0;
            const double square = x * x + y * y;
            if (square > 0.0 && square < 1.0)
                return x * std::sqrt(-2.0 * std::log(square) / square);
        }
    }

  private:
    std::mt19937_64 engine_;
};

}  // namespace psfm
