// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/edge_weight.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

TwoViewGeometry with_inliers(std::uint32_t count) {
    TwoViewGeometry geometry;
    for (std::uint32_t i = 0; i < count; ++i) geometry.inliers.push_back({i, i});
    return geometry;
}

TEST(EdgeWeight, IsTheNumberOfInliersFromTheBarOn) {
    const EdgeWeightOptions options{.min_inliers = 30};
    EXPECT_EQ(edge_weight(with_inliers(0), options), 0.0);
    EXPECT_EQ(edge_weight(with_inliers(29), options), 0.0);
    EXPECT_EQ(edge_weight(with_inliers(30), options), 30.0);
    EXPECT_EQ(edge_weight(with_inliers(1393), options), 1393.0);
}

TEST(EdgeWeight, RefusesABarOfZero) {
    EXPECT_TRUE(validate(EdgeWeightOptions{}).ok());
    EXPECT_FALSE(validate(EdgeWeightOptions{.min_inliers = 0}).ok());
}

}  // namespace
}  // namespace psfm
