// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/values/image_evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace psfm {
namespace {

TEST(ImageEvidence, AxesAreEastNorthUp) {
    const GpsPosition datum{55.698, 13.195, 37.0};
    EXPECT_LT(enu_from_wgs84(datum, datum).norm(), 1e-9);
    // A degree of the meridian is 111 340 m there, one of the parallel 62 867 m (WGS 84).
    const Eigen::Vector3d north = enu_from_wgs84(datum, {55.699, 13.195, 37.0});
    EXPECT_NEAR(north.y(), 111.34, 0.02);
    EXPECT_LT(std::hypot(north.x(), north.z()), 0.01);
    const Eigen::Vector3d east = enu_from_wgs84(datum, {55.698, 13.196, 37.0});
    EXPECT_NEAR(east.x(), 62.87, 0.02);
    const Eigen::Vector3d up = enu_from_wgs84(datum, {55.698, 13.195, 47.0});
    EXPECT_LT((up - Eigen::Vector3d(0.0, 0.0, 10.0)).norm(), 1e-6);
    EXPECT_NEAR(enu_from_wgs84(datum, {55.698, 13.195, std::nullopt}).z(), 0.0, 1e-9);
}

TEST(ImageEvidence, TheDatumIsTheFirstPlausiblePosition) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(datum_of({}, {}));
    std::vector<ImageEvidence> evidence{{ImageId{0}, std::nullopt},
                                        {ImageId{1}, GpsPosition{0.0, 0.0, 5.0}},
                                        {ImageId{2}, GpsPosition{91.0, 10.0, 5.0}},
                                        {ImageId{3}, GpsPosition{nan, 10.0, 5.0}},
                                        {ImageId{4}, GpsPosition{40.0, 181.0, 5.0}},
                                        {ImageId{5}, GpsPosition{40.0, 10.0, nan}}};
    EXPECT_FALSE(datum_of(evidence, {}));
    evidence.push_back({ImageId{6}, GpsPosition{0.0, 9.0, std::nullopt}});
    evidence.push_back({ImageId{8}, GpsPosition{40.0, 9.0, 100.0}});
    EXPECT_EQ(datum_of(evidence, {}), (GpsPosition{0.0, 9.0, 0.0}));
    EXPECT_EQ(find_evidence(evidence, ImageId{8}), &evidence.back());
    EXPECT_EQ(find_evidence(evidence, ImageId{7}), nullptr);
}

constexpr GpsPosition kLund{55.7, 13.2, 50.0};
constexpr GpsPosition kSydney{-33.9, 151.2, 10.0};

std::vector<ImageEvidence> evidence_at(const std::vector<GpsPosition>& positions) {
    std::vector<ImageEvidence> evidence;
    for (const GpsPosition& position : positions) {
        GpsPosition moved = position;
        moved.latitude_deg += 1e-4 * static_cast<double>(evidence.size());
        evidence.push_back({static_cast<ImageId>(evidence.size()), moved});
    }
    return evidence;
}

TEST(ImageEvidence, AWrongFixIsNoDatum) {
    std::vector<GpsPosition> positions(12, kLund);
    for (std::size_t wrong = 0; wrong < 12; ++wrong) {
        auto one_wrong = positions;
        one_wrong[wrong] = kSydney;
        const auto datum = datum_of(evidence_at(one_wrong), {});
        ASSERT_TRUE(datum);
        EXPECT_NEAR(datum->latitude_deg, 55.7, 0.01) << wrong;
        EXPECT_NEAR(datum->latitude_deg - 55.7, wrong == 0 ? 1e-4 : 0.0, 1e-9) << wrong;
    }
    // An old fix, kept until the receiver had a new one.
    positions[0] = positions[1] = positions[2] = kSydney;
    EXPECT_NEAR(datum_of(evidence_at(positions), {})->latitude_deg, 55.7, 0.01);
}

TEST(ImageEvidence, ASessionThatGoesOnElsewhereKeepsItsDatum) {
    std::vector<GpsPosition> positions(10, kLund);
    for (int day = 0; day < 19; ++day) {
        positions.push_back(kSydney);
        EXPECT_NEAR(datum_of(evidence_at(positions), {})->latitude_deg, 55.7, 1e-9) << day;
    }
}

TEST(ImageEvidence, WhatStandsInOneModelIsInOnePlace) {
    // Old fixes of the first five of twelve; then ten photographs of Sydney indeed.
    std::vector<GpsPosition> positions(5, kSydney);
    positions.insert(positions.end(), 7, kLund);
    positions.insert(positions.end(), 10, kSydney);
    const std::vector<ImageEvidence> evidence = evidence_at(positions);
    EXPECT_NEAR(datum_of(evidence, {})->latitude_deg, -33.9, 0.01) << "nothing is known of models";
    std::vector<std::vector<ImageId>> parts(2);
    for (std::uint32_t image = 0; image < 22; ++image)
        parts[image < 12 ? 1 : 0].push_back(static_cast<ImageId>(image));
    EXPECT_NEAR(datum_of(evidence, parts)->latitude_deg, 55.7005, 1e-9);
    std::ranges::reverse(parts[1]);
    EXPECT_NEAR(datum_of(evidence, parts)->latitude_deg, 55.7005, 1e-9);
    parts = {{ImageId{0}, ImageId{5}}};  // as many here as there
    EXPECT_NEAR(datum_of(evidence, parts)->latitude_deg, -33.9, 1e-9);
}

TEST(ImageEvidence, AWayOfManyKilometresIsOnePlace) {
    std::vector<GpsPosition> positions;
    for (int step = 0; step < 60; ++step)
        positions.push_back({55.7, 13.2 + 0.1 * step, std::nullopt});  // 6 km each
    EXPECT_NEAR(datum_of(evidence_at(positions), {})->longitude_deg, 13.2, 1e-9);
    // Across the date line, too.
    for (GpsPosition& position : positions)
        position.longitude_deg = std::remainder(position.longitude_deg + 165.0, 360.0);
    EXPECT_NEAR(datum_of(evidence_at(positions), {})->longitude_deg, 178.2, 1e-9);
}

}  // namespace
}  // namespace psfm
