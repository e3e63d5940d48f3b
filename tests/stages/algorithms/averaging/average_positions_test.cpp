// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/average_positions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "stages/algorithms/averaging/filter_directions.h"
#include "tests/stages/reconstruction/planted_directions.h"

namespace psfm {
namespace {

Result<PositionAveraging> average(const PlantedDirections& planted) {
    return average_positions(planted.edges, static_cast<std::uint32_t>(planted.positions.size()),
                             {});
}

PositionAveraging averaged(const PlantedDirections& planted) {
    auto result = average(planted);
    EXPECT_TRUE(result.ok()) << result.error().message;
    if (result.ok()) return *std::move(result);
    PositionAveraging none;
    none.position.resize(planted.positions.size());
    return none;
}

/// The edges that the filter keeps.
PlantedDirections filtered(PlantedDirections planted) {
    const auto nodes = static_cast<std::uint32_t>(planted.positions.size());
    const auto filter = filter_directions(planted.edges, nodes, {}, 3);
    EXPECT_TRUE(filter.ok());
    std::vector<RelativeDirection> kept;
    for (const std::uint32_t e : filter->kept) kept.push_back(planted.edges[e]);
    planted.edges = kept;
    return planted;
}

TEST(AveragePositions, RecoversExactPositions) {
    const PlantedDirections planted = plant_directions(cloud(50, 1), 0.9, 0.0, 2);
    const PositionAveraging result = averaged(planted);
    EXPECT_EQ(result.placed, 50U);
    EXPECT_LT(max_position_error(result.position, planted.positions), 1e-4);
}

TEST(AveragePositions, WithstandsNoise) {
    const PlantedDirections planted = plant_directions(cloud(100, 3), 0.8, 1.0, 4);
    const PositionAveraging result = averaged(planted);
    EXPECT_EQ(result.placed, 100U);
    EXPECT_LT(max_position_error(result.position, planted.positions), 0.02);
    EXPECT_NEAR(result.noise_deg, 1.0, 0.15);
}

TEST(AveragePositions, WithstandsRandomOutliersWithoutAFilter) {
    PlantedDirections planted = plant_directions(cloud(100, 5), 0.8, 0.5, 6);
    plant_random_outliers(planted, 0.15, 7);
    const PositionAveraging result = averaged(planted);
    EXPECT_EQ(result.placed, 100U);
    EXPECT_LT(max_position_error(result.position, planted.positions), 0.05);
}

TEST(AveragePositions, WithTheFilterWithstandsMore) {
    PlantedDirections planted = plant_directions(cloud(100, 3), 1.2, 1.0, 4);
    plant_random_outliers(planted, 0.35, 5);
    const PositionAveraging with = averaged(filtered(planted));
    const PositionAveraging without = averaged(planted);
    EXPECT_EQ(with.placed, 100U);
    const double error = max_position_error(with.position, planted.positions);
    EXPECT_LT(error, 0.05);
    EXPECT_LT(error, max_position_error(without.position, planted.positions));
}

TEST(AveragePositions, WithTheFilterWithstandsConsistentOutliers) {
    PlantedDirections planted = plant_directions(cloud(80, 11), 1.0, 0.5, 12);
    plant_shifted_nodes(planted, 15, 0.3, {1.5, 0.0, 0.0}, 13);
    const PositionAveraging result = averaged(filtered(planted));
    EXPECT_EQ(result.placed, 80U);
    EXPECT_LT(max_position_error(result.position, planted.positions), 0.05);
}

TEST(AveragePositions, PlacesALargeRingOfShortEdges) {
    // Each node sees five on either side; errors add up around the ring, and it closes.
    const PlantedDirections planted = plant_directions(ring(150, 0.05, 14), 0.21, 0.3, 15);
    const PositionAveraging result = averaged(planted);
    EXPECT_EQ(result.placed, 150U);
    EXPECT_LT(max_position_error(result.position, planted.positions), 0.05);
}

TEST(AveragePositions, FixesTheGauge) {
    const PlantedDirections planted = plant_directions(cloud(40, 16), 0.9, 1.0, 17);
    const PositionAveraging result = averaged(planted);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& position : result.position) mean += *position / 40.0;
    EXPECT_LT(mean.norm(), 1e-9);
    std::vector<double> lengths;
    for (const RelativeDirection& edge : planted.edges) {
        lengths.push_back((*result.position[edge.j] - *result.position[edge.i]).norm());
    }
    std::ranges::sort(lengths);
    EXPECT_NEAR(lengths[lengths.size() / 2], 1.0, 1e-9);
}

TEST(AveragePositions, ReportsTheResidualOfAWrongEdge) {
    PlantedDirections planted = plant_directions(cloud(40, 18), 0.9, 0.0, 19);
    const Eigen::Vector3d across = planted.edges[5].direction.unitOrthogonal();
    planted.edges[5].direction = Eigen::AngleAxisd(0.5, across) * planted.edges[5].direction;
    const PositionAveraging result = averaged(planted);
    EXPECT_NEAR(*result.residual_deg[5], 0.5 * 180.0 / std::numbers::pi, 1.0);
    EXPECT_LT(*result.residual_deg[6], 1.0);
}

TEST(AveragePositions, PlacesTheLargestComponentOnly) {
    PlantedDirections planted = plant_directions(cloud(20, 20), 3.0, 0.3, 21);
    const PlantedDirections other = plant_directions(cloud(30, 22), 3.0, 0.3, 23);
    planted.positions.insert(planted.positions.end(), other.positions.begin(),
                             other.positions.end());
    for (RelativeDirection edge : other.edges) {
        edge.i += 20;
        edge.j += 20;
        planted.edges.push_back(edge);
    }
    const PositionAveraging result = averaged(planted);
    EXPECT_EQ(result.placed, 30U);
    for (std::size_t node = 0; node < 20; ++node) EXPECT_FALSE(result.position[node]);
    EXPECT_FALSE(result.residual_deg.front());
    EXPECT_LT(max_position_error(result.position, planted.positions), 0.02);
}

TEST(AveragePositions, DoesNotGuessTheScaleOfPartsThatShareOneNode) {
    // Two clouds whose only common node is the first.
    PlantedDirections planted = plant_directions(cloud(41, 24), 3.0, 0.3, 25);
    std::erase_if(planted.edges, [](const RelativeDirection& edge) {
        return edge.i != 0 && (edge.i <= 25) != (edge.j <= 25);
    });
    const PositionAveraging result = averaged(planted);
    EXPECT_EQ(result.placed, 26U);
    EXPECT_TRUE(result.position[0] && result.position[25]);
    EXPECT_FALSE(result.position[26]);
    EXPECT_LT(max_position_error(result.position, planted.positions), 0.02);
}

TEST(AveragePositions, LeavesOutANodeWithOneEdge) {
    PlantedDirections planted = plant_directions(cloud(30, 26), 3.0, 0.3, 27);
    std::erase_if(planted.edges,
                  [](const RelativeDirection& edge) { return edge.j == 29 && edge.i != 4; });
    const PositionAveraging result = averaged(planted);
    EXPECT_EQ(result.placed, 29U);
    EXPECT_FALSE(result.position[29]);
}

TEST(AveragePositions, DoesNotGuessDistancesOnALine) {
    // In general position all of this graph is rigid: the line is what makes it not so.
    const auto exact = average(plant_directions(line(30, 0.0, 28), 2.0, 0.0, 29));
    ASSERT_FALSE(exact.ok());
    EXPECT_EQ(exact.error().code, ErrorCode::kDegenerate);
    // With noise, what it makes of the line passes for a shape here and there.
    for (const double deviation : {0.0, 1e-4}) {
        for (const double reach : {0.3, 2.0}) {
            const auto noisy = average(plant_directions(line(30, deviation, 28), reach, 0.5, 29));
            EXPECT_LE(noisy.ok() ? noisy->placed : 0U, 12U);
        }
    }
    EXPECT_EQ(averaged(plant_directions(line(30, 0.1, 28), 2.0, 0.5, 29)).placed, 30U);
}

TEST(AveragePositions, PlacesALineThroughPointsBesideIt) {
    PlantedDirections planted = plant_directions(line(30, 0.0, 30), 0.2, 0.3, 31);
    synthetic::Rng rng(32);
    for (int k = 0; k < 60; ++k) {
        const Eigen::Vector3d point(rng.uniform(), 0.15 + 0.1 * rng.uniform(), 0.1 * rng.normal());
        const auto node = static_cast<std::uint32_t>(planted.positions.size());
        for (std::uint32_t i = 0; i < 30; ++i) {
            const Eigen::Vector3d difference = point - planted.positions[i];
            if (difference.norm() > 0.35) continue;
            planted.edges.push_back({i, node, turned(difference.normalized(), 0.3, rng), 1.0});
        }
        planted.positions.push_back(point);
    }
    const PositionAveraging result = averaged(planted);
    for (std::size_t node = 0; node < 30; ++node) EXPECT_TRUE(result.position[node]);
    EXPECT_LT(max_position_error(result.position, planted.positions), 0.03);
}

TEST(AveragePositions, IsBitwiseRepeatable) {
    PlantedDirections planted = plant_directions(cloud(60, 33), 0.9, 1.0, 34);
    plant_random_outliers(planted, 0.1, 35);
    const PositionAveraging a = averaged(planted);
    const PositionAveraging b = averaged(planted);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.residual_deg, b.residual_deg);
}

TEST(AveragePositions, RefusesWhatHasNoPositions) {
    EXPECT_EQ(average_positions({}, 4, {}).error().code, ErrorCode::kDegenerate);
    const std::vector<RelativeDirection> one{{0, 1, Eigen::Vector3d::UnitX(), 1.0}};
    EXPECT_EQ(average_positions(one, 2, {}).error().code, ErrorCode::kDegenerate);
    EXPECT_EQ(average_positions(one, 1, {}).error().code, ErrorCode::kInvalidArgument);
    PositionAveragingOptions options;
    options.loss_scale_deg = 0.0;
    EXPECT_EQ(average_positions(one, 2, options).error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace psfm
