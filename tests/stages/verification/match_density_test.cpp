// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/match_density.h"

#include <gtest/gtest.h>

#include <random>

namespace psfm {
namespace {

constexpr std::uint32_t kWidth = 1000, kHeight = 800;

Keypoint at(double x, double y) {
    Keypoint keypoint;
    keypoint.x = static_cast<float>(x);
    keypoint.y = static_cast<float>(y);
    return keypoint;
}

/// Two photographs of a plane, the second shifted by `shift` px to the left; `rate` of the points
/// that both show are matched.
struct Shifted {
    Keypoints first, second;
    std::vector<FeatureMatch> matches;

    Shifted(double shift, double rate) {
        std::mt19937_64 rng(7);
        std::uniform_real_distribution<double> unit;
        for (int i = 0; i < 4000; ++i) {
            const double x = unit(rng) * (kWidth + shift);
            const double y = unit(rng) * kHeight;
            const bool in_first = x < kWidth;
            const bool in_second = x >= shift;
            if (in_first) first.push_back(at(x, y));
            if (in_second) second.push_back(at(x - shift, y));
            if (in_first && in_second && unit(rng) < rate) {
                matches.push_back({static_cast<std::uint32_t>(first.size() - 1),
                                   static_cast<std::uint32_t>(second.size() - 1)});
            }
        }
    }
    MatchDensity densities() const {
        const Camera camera = make_camera(kWidth, kHeight, 900.0, FocalSource::kExif);
        return match_density({first, second, camera, camera, matches}, matches);
    }
    double density() const { return densities().shared; }
};

TEST(MatchDensity, IsThePartOfSharedFeaturesThatMatch) {
    EXPECT_NEAR(Shifted(0.0, 0.3).density(), 0.3, 0.03);
    EXPECT_NEAR(Shifted(0.0, 0.05).density(), 0.05, 0.02);
}

TEST(MatchDensity, DoesNotPunishASmallOverlap) {
    EXPECT_NEAR(Shifted(800.0, 0.3).density(), 0.3, 0.05);
}

TEST(MatchDensity, IsLowWhenOnlyAPatchRepeats) {
    Shifted views(0.0, 0.5);
    std::erase_if(views.matches, [&](const FeatureMatch& match) {
        return views.first[match.first].x > 300.0F || views.first[match.first].y > 300.0F;
    });
    ASSERT_GT(views.matches.size(), 50U);
    EXPECT_LT(views.density(), 0.08) << "the photographs should share all the rest as well";
    EXPECT_NEAR(views.densities().core, 0.5, 0.1) << "within the patch they do";
}

TEST(MatchDensity, CopesWithMatchesOnALine) {
    Shifted views(0.0, 1.0);
    std::erase_if(views.matches,
                  [&](const FeatureMatch& match) { return views.first[match.first].y > 2.0F; });
    ASSERT_GE(views.matches.size(), 3U);
    const double density = views.density();
    EXPECT_GT(density, 0.0);
    EXPECT_LT(density, 0.05);
}

TEST(MatchDensity, IsZeroWithoutInliers) {
    const Shifted views(0.0, 0.5);
    const Camera camera = make_camera(kWidth, kHeight, 900.0, FocalSource::kExif);
    EXPECT_EQ(match_density({views.first, views.second, camera, camera, {}}, {}).shared, 0.0);
}

}  // namespace
}  // namespace psfm
