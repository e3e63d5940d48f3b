// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/distinct_points.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

std::vector<ExportedPoint> points_at(const std::vector<Eigen::Vector3d>& places) {
    std::vector<ExportedPoint> points;
    for (const Eigen::Vector3d& place : places) {
        ExportedPoint& point = points.emplace_back();
        point.id = points.size();
        point.position = place;
    }
    return points;
}

TEST(DistinctPoints, OfPointsAtOnePlaceTheFirstStays) {
    const auto points =
        points_at({{3, 1, 2}, {0, 0, 0}, {3, 1, 2}, {-1, 5, 2}, {0, 0, 0}, {3, 1, 2.5}});
    EXPECT_EQ(distinct_points(points, Eigen::Vector3d::Zero()),
              (std::vector<std::size_t>{0, 1, 3, 5}));
    EXPECT_TRUE(distinct_points({}, Eigen::Vector3d::Zero()).empty());
}

TEST(DistinctPoints, PlacesAreThoseOfFloatsFromTheOrigin) {
    // A millimetre apart, 6,000 km from the origin: floats tell them apart only near it.
    const Eigen::Vector3d far(6e6, 0, 0);
    const auto points = points_at({far, far + Eigen::Vector3d(0.001, 0, 0)});
    EXPECT_EQ(distinct_points(points, Eigen::Vector3d::Zero()).size(), 1U);
    EXPECT_EQ(distinct_points(points, far).size(), 2U);
}

}  // namespace
}  // namespace psfm
