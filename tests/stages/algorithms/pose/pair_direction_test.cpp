// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/pose/pair_direction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

/// Two cameras a unit apart, and points in front of them.
struct Views {
    Eigen::Vector3d direction;
    std::vector<Eigen::Vector3d> rays1;
    std::vector<Eigen::Vector3d> rays2;
};

Views make_views(std::size_t points, double noise_rad, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    Views views{rng.direction(), {}, {}};
    const Eigen::Vector3d ahead = rng.direction();
    for (std::size_t k = 0; k < points; ++k) {
        const Eigen::Vector3d point = 5.0 * ahead + rng.normal3();
        views.rays1.push_back((point.normalized() + noise_rad * rng.normal3()).normalized());
        views.rays2.push_back(
            ((point - views.direction).normalized() + noise_rad * rng.normal3()).normalized());
    }
    return views;
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

/// A direction 10 degrees off.
Eigen::Vector3d near(const Eigen::Vector3d& direction) {
    return (direction + std::tan(10.0 * std::numbers::pi / 180.0) * direction.unitOrthogonal())
        .normalized();
}

TEST(DirectionBetween, IsExactForExactRays) {
    const Views views = make_views(30, 0.0, 1);
    const Eigen::Vector3d found =
        direction_between(views.rays1, views.rays2, near(views.direction));
    EXPECT_LT(angle_deg(found, views.direction), 1e-4);
}

TEST(DirectionBetween, FindsTheSignThatPutsPointsInFront) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Views views = make_views(50, 1e-3, seed);
        const Eigen::Vector3d found =
            direction_between(views.rays1, views.rays2, -near(views.direction));
        EXPECT_LT(angle_deg(found, views.direction), 5.0) << seed;
    }
}

TEST(DirectionBetween, WithstandsWrongMatches) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Views views = make_views(200, 3e-4, seed);
        for (std::size_t k = 0; k < 25; ++k) std::swap(views.rays2[k], views.rays2[k + 25]);
        const Eigen::Vector3d found =
            direction_between(views.rays1, views.rays2, near(views.direction));
        EXPECT_LT(angle_deg(found, views.direction), 1.0) << seed;
    }
}

}  // namespace
}  // namespace psfm
