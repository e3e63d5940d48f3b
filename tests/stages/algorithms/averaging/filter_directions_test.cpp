// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/filter_directions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/stages/reconstruction/planted_directions.h"

namespace psfm {
namespace {

DirectionFilter filter(const PlantedDirections& planted,
                       const DirectionFilterOptions& options = {}) {
    auto result = filter_directions(
        planted.edges, static_cast<std::uint32_t>(planted.positions.size()), options, 7);
    EXPECT_TRUE(result.ok()) << result.error().message;
    return result.ok() ? *result : DirectionFilter{};
}

/// Parts of the right and of the wrong edges that were dropped.
struct Dropped {
    double right = 0.0;
    double wrong = 0.0;
};

Dropped dropped_edges(const PlantedDirections& planted, const DirectionFilter& result) {
    Dropped dropped;
    double right = 0.0;
    double wrong = 0.0;
    for (std::uint32_t e = 0; e < planted.edges.size(); ++e) {
        const bool out = !std::ranges::binary_search(result.kept, e);
        (planted.wrong[e] ? wrong : right) += 1.0;
        (planted.wrong[e] ? dropped.wrong : dropped.right) += out ? 1.0 : 0.0;
    }
    dropped.right /= std::max(right, 1.0);
    dropped.wrong /= std::max(wrong, 1.0);
    return dropped;
}

TEST(FilterDirections, FindsNothingWrongInExactDirections) {
    const PlantedDirections planted = plant_directions(cloud(60, 1), 0.8, 0.0, 2);
    const DirectionFilter result = filter(planted);
    EXPECT_EQ(result.kept.size(), planted.edges.size());
    EXPECT_EQ(*std::ranges::max_element(result.score), 0.0);
}

TEST(FilterDirections, DropsRandomOutliersAndKeepsNoisyEdges) {
    PlantedDirections planted = plant_directions(cloud(100, 3), 1.2, 1.0, 4);
    plant_random_outliers(planted, 0.2, 5);
    const Dropped dropped = dropped_edges(planted, filter(planted));
    EXPECT_LT(dropped.right, 0.05);
    // A seventh of all directions is within 45 degrees of the right one, and does little harm.
    EXPECT_GT(dropped.wrong, 0.65);
}

TEST(FilterDirections, DropsOutliersThatAgreeWithOneAnotherBeforeOthers) {
    // Seen from most nodes, the shift turns a direction by less than 45 degrees.
    PlantedDirections planted = plant_directions(cloud(100, 6), 1.2, 1.0, 7);
    plant_shifted_nodes(planted, 15, 0.1, {1.5, 0.0, 0.0}, 8);
    const DirectionFilter result = filter(planted);
    const Dropped dropped = dropped_edges(planted, result);
    EXPECT_LT(dropped.right, 0.01);
    EXPECT_GT(dropped.wrong, 0.15);
    double right = 0.0;
    double wrong = 0.0;
    for (std::size_t e = 0; e < planted.edges.size(); ++e) {
        (planted.wrong[e] ? wrong : right) += result.score[e];
    }
    const auto count = static_cast<double>(std::ranges::count(planted.wrong, true));
    EXPECT_GT(wrong / count, 5.0 * right / (static_cast<double>(planted.edges.size()) - count));
}

TEST(FilterDirections, LetsHeavyEdgesDecide) {
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
    const auto cycle = [&](double w01, double w12, double w20) {
        const std::vector<RelativeDirection> edges{{0, 1, x, w01}, {1, 2, x, w12}, {2, 0, x, w20}};
        return filter_directions(edges, 3, {}, 1)->kept;
    };
    using Indices = std::vector<std::uint32_t>;
    EXPECT_EQ(cycle(3.0, 3.0, 1.0), (Indices{0, 1}));
    EXPECT_EQ(cycle(1.0, 3.0, 3.0), (Indices{1, 2}));
    EXPECT_EQ(cycle(3.0, 1.0, 3.0), (Indices{0, 2}));
}

TEST(FilterDirections, DropsMoreWithALowerBound) {
    PlantedDirections planted = plant_directions(cloud(60, 9), 0.9, 3.0, 10);
    plant_random_outliers(planted, 0.2, 11);
    DirectionFilterOptions options;
    std::size_t before = 0;
    for (const double bound : {0.0, 0.02, 0.1, 0.3, 1.0}) {
        options.max_score = bound;
        const std::size_t kept = filter(planted, options).kept.size();
        EXPECT_GT(kept, before);
        before = kept;
    }
    EXPECT_EQ(before, planted.edges.size());
}

TEST(FilterDirections, IsRepeatable) {
    PlantedDirections planted = plant_directions(cloud(50, 12), 0.9, 2.0, 13);
    plant_random_outliers(planted, 0.2, 14);
    const auto a = filter_directions(planted.edges, 50, {}, 1);
    const auto b = filter_directions(planted.edges, 50, {}, 1);
    const auto other_axes = filter_directions(planted.edges, 50, {}, 2);
    EXPECT_EQ(a->score, b->score);
    EXPECT_EQ(a->kept, b->kept);
    EXPECT_NE(a->score, other_axes->score);
}

TEST(FilterDirections, AcceptsParallelEdgesAndEmptyGraphs) {
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
    const std::vector<RelativeDirection> parallel{{0, 1, x, 1.0}, {0, 1, x, 1.0}, {1, 0, x, 1.0}};
    EXPECT_EQ(filter_directions(parallel, 2, {}, 1)->kept, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_TRUE(filter_directions({}, 5, {}, 1)->kept.empty());
}

TEST(FilterDirections, RefusesBrokenInput) {
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
    const std::vector<std::vector<RelativeDirection>> broken{
        {{0, 0, x, 1.0}},
        {{0, 2, x, 1.0}},
        {{0, 1, x, 0.0}},
        {{0, 1, 2.0 * x, 1.0}},
        {{0, 1, Eigen::Vector3d::Constant(std::nan("")), 1.0}}};
    for (const std::vector<RelativeDirection>& edges : broken) {
        const auto result = filter_directions(edges, 2, {}, 1);
        ASSERT_FALSE(result.ok());
        EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
    }
    DirectionFilterOptions options;
    options.axes = 0;
    EXPECT_FALSE(filter_directions({}, 2, options, 1).ok());
}

}  // namespace
}  // namespace psfm
