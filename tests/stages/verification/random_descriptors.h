// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "graph/image.h"

namespace psfm {

inline Descriptors random_bytes(std::size_t rows, int low, int high, std::uint32_t seed) {
    std::mt19937 random(seed);
    Descriptors out;
    out.values.resize(rows * Descriptors::kSize);
    for (std::uint8_t& value : out.values) {
        value = static_cast<std::uint8_t>(
            low + static_cast<int>(random() % static_cast<std::uint32_t>(high - low + 1)));
    }
    return out;
}

/// Rows of length 512 like RootSIFT's.
inline Descriptors random_root_sift(std::size_t rows, std::uint32_t seed) {
    std::mt19937 random(seed);
    Descriptors out;
    for (std::size_t i = 0; i < rows; ++i) {
        std::array<double, Descriptors::kSize> histogram{};
        double sum = 0.0;
        for (double& bin : histogram)
            sum += bin = -std::log(static_cast<double>(random() % 1000 + 1) / 1001.0);
        for (const double bin : histogram) {
            out.values.push_back(static_cast<std::uint8_t>(
                std::min(255.0, std::round(512.0 * std::sqrt(bin / sum)))));
        }
    }
    return out;
}

/// `of` in another order, with noise: a known answer for matching.
inline Descriptors shuffled_and_noisy(const Descriptors& of, std::vector<std::size_t>& source,
                                      int noise, std::uint32_t seed) {
    std::mt19937 random(seed);
    source.resize(of.rows());
    for (std::size_t i = 0; i < source.size(); ++i) source[i] = i;
    for (std::size_t i = source.size(); i-- > 1;) std::swap(source[i], source[random() % (i + 1)]);
    Descriptors out;
    for (const std::size_t i : source) {
        for (std::size_t k = 0; k < Descriptors::kSize; ++k) {
            const int offset =
                static_cast<int>(random() % static_cast<std::uint32_t>(2 * noise + 1)) - noise;
            out.values.push_back(
                static_cast<std::uint8_t>(std::clamp(of.row(i)[k] + offset, 0, 255)));
        }
    }
    return out;
}

}  // namespace psfm
