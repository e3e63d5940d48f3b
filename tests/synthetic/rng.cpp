// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/rng.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace psfm::synthetic {

std::size_t Rng::below(std::size_t count) {
    // Values above the last whole multiple of count would favour small results: draw again.
    const std::uint64_t limit = std::numeric_limits<std::uint64_t>::max() / count * count;
    std::uint64_t value = engine_();
    while (value >= limit) value = engine_();
    return static_cast<std::size_t>(value % count);
}

double Rng::normal() {
    for (;;) {
        const double u = uniform(-1.0, 1.0);
        const double v = uniform(-1.0, 1.0);
        const double s = u * u + v * v;
        if (s > 0.0 && s < 1.0) return u * std::sqrt(-2.0 * std::log(s) / s);
    }
}

Eigen::Vector3d Rng::normal3() {
    const double x = normal();
    const double y = normal();
    const double z = normal();
    return {x, y, z};
}

Eigen::Vector3d Rng::direction() {
    Eigen::Vector3d v = normal3();
    while (v.squaredNorm() < 1e-12) v = normal3();
    return v.normalized();
}

Eigen::Quaterniond Rng::rotation() {
    const double u = uniform();
    const double a = 2.0 * std::numbers::pi * uniform();
    const double b = 2.0 * std::numbers::pi * uniform();
    return Eigen::Quaterniond(std::sqrt(u) * std::cos(b), std::sqrt(1.0 - u) * std::sin(a),
                              std::sqrt(1.0 - u) * std::cos(a), std::sqrt(u) * std::sin(b))
        .normalized();
}

Eigen::Quaterniond Rng::small_rotation(double sigma_rad) {
    const Eigen::Vector3d axis = direction();
    return Eigen::Quaterniond(Eigen::AngleAxisd(normal() * sigma_rad, axis));
}

std::uint64_t mix_seed(std::uint64_t seed, std::uint64_t value) {
    std::uint64_t z = seed + 0x9e3779b97f4a7c15ULL * (value + 1);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31U);
}

std::vector<std::size_t> random_order(std::size_t count, std::uint64_t seed) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    Rng rng(seed);
    rng.shuffle(order);
    return order;
}

}  // namespace psfm::synthetic
