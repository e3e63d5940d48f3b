// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace psfm::synthetic {

/// Random numbers that are the same with every standard library: std::mt19937_64 is specified to
/// the bit, the std:: distributions are not, so these are our own. Not thread-safe: one a thread.
class Rng {
  public:
    explicit Rng(std::uint64_t seed) : engine_(seed) {}

    std::uint64_t bits() { return engine_(); }
    /// In [0, 1), 53 random bits.
    double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1.0p-53; }
    /// In [low, high).
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// In 0 … count - 1, without bias. REQUIRES: count > 0.
    std::size_t below(std::size_t count);
    /// Standard normal (Marsaglia's polar method; the second value of each pair is thrown away, so
    /// that there is no state besides the engine's).
    double normal();
    Eigen::Vector3d normal3();
    /// Uniform on the unit sphere.
    Eigen::Vector3d direction();
    /// Uniform over all rotations (Shoemake 1992).
    Eigen::Quaterniond rotation();
    /// Rotation about a uniform axis by |normal()| * sigma.
    Eigen::Quaterniond small_rotation(double sigma_rad);

    /// Fisher-Yates from the back.
    template <typename T>
    void shuffle(std::vector<T>& values) {
        for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
    }

  private:
    std::mt19937_64 engine_;
};

/// Mixes values into a seed: equal inputs give equal seeds, and neighbours unrelated ones
/// (splitmix64).
std::uint64_t mix_seed(std::uint64_t seed, std::uint64_t value);

/// The numbers 0 … count - 1 in random order: an order of arrival.
std::vector<std::size_t> random_order(std::size_t count, std::uint64_t seed);

}  // namespace psfm::synthetic
