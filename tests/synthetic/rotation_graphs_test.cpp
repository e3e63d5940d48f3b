// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/rotation_graphs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace psfm::synthetic {
namespace {

TEST(RandomRotations, PlantNoiseAndOutliersAsAskedFor) {
    const RandomRotationOptions options{
        .nodes = 60, .density = 0.4, .noise_sigma_deg = 0.5, .outlier_fraction = 0.25};
    const RotationGraph graph = make_random_rotations(options, 1);
    ASSERT_EQ(graph.cam_from_world.size(), 60U);
    double squares = 0.0;
    double right = 0.0;
    double wrong = 0.0;
    for (const RotationEdge& edge : graph.edges) {
        const double error_deg = edge_error_deg(edge, graph.cam_from_world);
        if (edge.truth == RotationEdgeTruth::kRight) {
            squares += error_deg * error_deg;
            right += 1.0;
            EXPECT_LT(error_deg, 3.0);
        } else {
            EXPECT_EQ(edge.truth, RotationEdgeTruth::kRandom);
            EXPECT_GE(error_deg, 20.0 - 1e-9);
            wrong += 1.0;
        }
    }
    EXPECT_NEAR(std::sqrt(squares / right), 0.5, 0.05);
    EXPECT_NEAR(wrong / (wrong + right - 59.0), 0.25, 0.05);
}

TEST(RandomRotations, AreConnectedByRightEdges) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const RotationGraph graph =
            make_random_rotations({.nodes = 20, .density = 0.05, .outlier_fraction = 1.0}, seed);
        std::vector<std::uint32_t> group(20);
        for (std::uint32_t i = 0; i < 20; ++i) group[i] = i;
        EXPECT_TRUE(std::ranges::is_sorted(graph.edges, {}, &RotationEdge::pair));
        for (const RotationEdge& edge : graph.edges) {
            if (edge.truth != RotationEdgeTruth::kRight) continue;
            const std::uint32_t from = group[index_of(edge.pair.first)];
            std::ranges::replace(group, from, group[index_of(edge.pair.second)]);
        }
        EXPECT_EQ(std::ranges::count(group, group[0]), 20);
    }
}

TEST(FoldedRing, RightEdgesAgreeWithTheTruthAndLookAlikesDoNot) {
    const FoldedRing ring = make_folded_ring({.noise_sigma_deg = 0.0}, 1);
    std::size_t right = 0;
    std::size_t wrong = 0;
    for (const RotationEdge& edge : ring.graph.edges) {
        const double error_deg = edge_error_deg(edge, ring.graph.cam_from_world);
        if (edge.truth == RotationEdgeTruth::kRight) {
            EXPECT_LT(error_deg, 1e-9);
            ++right;
        } else {
            EXPECT_EQ(edge.truth, RotationEdgeTruth::kConsistent);
            // A whole number of sides, 60 degrees each.
            const double off = std::remainder(error_deg, 60.0);
            EXPECT_NEAR(off, 0.0, 1e-9);
            EXPECT_GT(error_deg, 59.0);
            ++wrong;
        }
    }
    EXPECT_EQ(right, 60U * 5);
    EXPECT_GT(wrong, right) << "the wrong story has more edges";
}

TEST(FoldedRing, LookAlikesAgreeWithTheFoldedStoryButForTheSeam) {
    const FoldedRing ring = make_folded_ring({.noise_sigma_deg = 0.0}, 1);
    std::size_t agree = 0;
    std::size_t wrong = 0;
    std::size_t torn = 0;
    for (const RotationEdge& edge : ring.graph.edges) {
        const bool fits = edge_error_deg(edge, ring.folded_cam_from_world) < 1e-6;
        if (edge.truth == RotationEdgeTruth::kConsistent) {
            ++wrong;
            agree += fits ? 1 : 0;
        } else if (!fits) {
            ++torn;
        }
        // An edge disagrees only when its images lie on either side of the seam.
        if (fits) continue;
        const double error_deg = edge_error_deg(edge, ring.folded_cam_from_world);
        EXPECT_NEAR(error_deg, 60.0, 1e-6);
    }
    EXPECT_GT(agree, wrong * 3 / 4);
    EXPECT_LT(torn, ring.graph.edges.size() / 5);
    EXPECT_GT(torn, 0U) << "some true edge must tell the stories apart";
}

TEST(FoldedRing, WeighsEdgesAsTheTempleDoes) {
    // Of temple-341: inliers at 10, 20 and 30 degrees, and of look-alikes at 60 and 75.
    const FoldedRing ring = make_folded_ring({.nodes = 72}, 1);
    const auto weight = [&](std::uint32_t apart) {
        for (const RotationEdge& edge : ring.graph.edges) {
            if (edge.pair == ImagePair{ImageId{0}, ImageId{apart}}) return edge.weight;
        }
        return 0.0;
    };
    EXPECT_NEAR(weight(2), 356.0, 50.0);
    EXPECT_NEAR(weight(4), 150.0, 30.0);
    EXPECT_NEAR(weight(6), 63.0, 10.0);
    EXPECT_NEAR(weight(12), 172.0, 20.0);
    EXPECT_NEAR(weight(15), 41.0, 10.0);
    EXPECT_EQ(weight(7), 0.0) << "35 degrees: neither a neighbour nor near a look-alike";
}

TEST(MaxRotationError, IgnoresTheGauge) {
    const RotationGraph graph = make_random_rotations({.nodes = 10}, 2);
    const Eigen::Quaterniond gauge(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()));
    std::vector<Eigen::Quaterniond> estimate;
    for (const Eigen::Quaterniond& rotation : graph.cam_from_world)
        estimate.push_back(rotation * gauge);
    EXPECT_LT(max_rotation_error_deg(estimate, graph.cam_from_world), 1e-6);
    estimate[3] = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()) * estimate[3];
    EXPECT_NEAR(max_rotation_error_deg(estimate, graph.cam_from_world), 5.73, 0.8);
}

TEST(MakeViewGraph, CarriesRotationsAndWeights) {
    const FoldedRing ring = make_folded_ring({}, 3);
    const ViewGraph graph = make_view_graph(ring.graph);
    EXPECT_EQ(graph.edge_count(), ring.graph.edges.size());
    for (const RotationEdge& edge : ring.graph.edges) {
        const ViewGraph::Edge* found = graph.find(edge.pair.first, edge.pair.second);
        ASSERT_NE(found, nullptr);
        EXPECT_EQ(found->weight, edge.weight);
        ASSERT_NE(found->pair, nullptr);
        EXPECT_EQ(found->pair->geometry.inliers.size(), static_cast<std::size_t>(edge.weight));
        EXPECT_EQ(found->pair->geometry.cam2_from_cam1.rotation.coeffs(),
                  edge.cam2_from_cam1.coeffs());
    }
}

}  // namespace
}  // namespace psfm::synthetic
