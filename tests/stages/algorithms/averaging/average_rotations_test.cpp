// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/average_rotations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "graph/rigid3.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/rotation_graphs.h"

namespace psfm {
namespace {

using synthetic::max_rotation_error_deg;
using synthetic::RandomRotationOptions;
using synthetic::RotationEdgeTruth;
using synthetic::RotationGraph;

std::vector<RelativeRotation> edges_of(const RotationGraph& graph) {
    std::vector<RelativeRotation> edges;
    for (const synthetic::RotationEdge& edge : graph.edges) {
        edges.push_back({index_of(edge.pair.first), index_of(edge.pair.second), edge.cam2_from_cam1,
                         edge.weight});
    }
    return edges;
}

RotationAveraging average(const RotationGraph& graph,
                          const RotationAveragingOptions& options = {}) {
    auto result = average_rotations(
        edges_of(graph), static_cast<std::uint32_t>(graph.cam_from_world.size()), options);
    EXPECT_TRUE(result.ok()) << result.error().message;
    return result.ok() ? *result : RotationAveraging{};
}

/// Parts of the right and of the wrong edges within 10 degrees, the paper's rho_g,max.
struct Kept {
    double right = 0.0;
    double wrong = 0.0;
};

Kept kept_edges(const RotationGraph& graph, const RotationAveraging& averaging) {
    const std::vector<std::uint32_t> within = edges_within(averaging, 10.0);
    Kept kept;
    double right = 0.0;
    double wrong = 0.0;
    for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
        const bool in = std::ranges::binary_search(within, e);
        const bool is_right = graph.edges[e].truth == RotationEdgeTruth::kRight;
        (is_right ? right : wrong) += 1.0;
        (is_right ? kept.right : kept.wrong) += in ? 1.0 : 0.0;
    }
    kept.right /= std::max(right, 1.0);
    kept.wrong /= std::max(wrong, 1.0);
    return kept;
}

TEST(AverageRotations, IsExactWithoutNoise) {
    const RotationGraph graph = synthetic::make_random_rotations(
        {.nodes = 40, .density = 0.2, .noise_sigma_deg = 0.0, .outlier_fraction = 0.0}, 1);
    const RotationAveraging result = average(graph);
    EXPECT_LT(max_rotation_error_deg(result.node_from_reference, graph.cam_from_world), 1e-6);
    EXPECT_LT(*std::ranges::max_element(result.residual_deg), 1e-6);
    EXPECT_EQ(result.component_count, 1U);
    EXPECT_LT(rotation_angle(result.node_from_reference[0]), 1e-12);
}

TEST(AverageRotations, ConventionIsCamFromReference) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 3).normalized()));
    const std::vector<RelativeRotation> edges{{0, 1, turn, 10.0}, {2, 1, turn, 10.0}};
    auto result = average_rotations(edges, 3, {});
    ASSERT_TRUE(result.ok());
    EXPECT_LT(angle_between(result->node_from_reference[1], turn), 1e-12);
    EXPECT_LT(rotation_angle(result->node_from_reference[2]), 1e-12);
}

TEST(AverageRotations, SpreadsNoiseOverTheGraph) {
    const RotationGraph graph = synthetic::make_random_rotations(
        {.nodes = 60, .density = 0.2, .noise_sigma_deg = 1.0, .outlier_fraction = 0.0}, 2);
    const RotationAveraging start = average(graph, {.max_iterations = 0});
    const RotationAveraging result = average(graph);
    EXPECT_EQ(start.residual_deg, start.start_residual_deg);
    EXPECT_EQ(result.start_residual_deg, start.start_residual_deg);
    const double before = max_rotation_error_deg(start.node_from_reference, graph.cam_from_world);
    const double after = max_rotation_error_deg(result.node_from_reference, graph.cam_from_world);
    EXPECT_LT(after, 0.8);
    EXPECT_LT(after, 0.4 * before);
}

TEST(AverageRotations, RejectsPlantedOutliers) {
    for (const double fraction : {0.1, 0.2, 0.3}) {
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
            const RotationGraph graph = synthetic::make_random_rotations(
                {.nodes = 60, .density = 0.4, .noise_sigma_deg = 0.5, .outlier_fraction = fraction},
                seed);
            const RotationAveraging result = average(graph);
            EXPECT_LT(max_rotation_error_deg(result.node_from_reference, graph.cam_from_world),
                      1.0);
            const Kept kept = kept_edges(graph, result);
            EXPECT_EQ(kept.right, 1.0);
            EXPECT_EQ(kept.wrong, 0.0);
        }
    }
}

// As --preset paper has it.
TEST(AverageRotations, RejectsThemByTheSumOfCoordinatesToo) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
        const RotationGraph graph = synthetic::make_random_rotations(
            {.nodes = 60, .density = 0.4, .noise_sigma_deg = 0.5, .outlier_fraction = 0.2}, seed);
        const RotationAveraging result = average(graph, {.norm = RotationNorm::kCoordinates});
        EXPECT_LT(max_rotation_error_deg(result.node_from_reference, graph.cam_from_world), 2.0);
        const Kept kept = kept_edges(graph, result);
        EXPECT_EQ(kept.right, 1.0);
        EXPECT_EQ(kept.wrong, 0.0);
    }
}

TEST(AverageRotations, KeepsACleanRing) {
    const RotationGraph ring =
        synthetic::make_folded_ring({.nodes = 60, .look_alike_ratio = 0.0}, 3).graph;
    ASSERT_TRUE(std::ranges::all_of(
        ring.edges, [](const auto& edge) { return edge.truth == RotationEdgeTruth::kRight; }));
    const RotationAveraging result = average(ring);
    EXPECT_EQ(kept_edges(ring, result).right, 1.0);
    EXPECT_LT(max_rotation_error_deg(result.node_from_reference, ring.cam_from_world), 1.0);
}

/// The temple of docs/look-alikes.md: where look-alikes agree with one another, the L1 optimum of
/// all edges is wrong although its start is right. Stands here so that nobody takes the default for
/// safe.
TEST(AverageRotations, L1OverAllEdgesFoldsARingOfLookAlikes) {
    const synthetic::FoldedRing ring = synthetic::make_folded_ring({.nodes = 114}, 1);
    const RotationAveraging start = average(ring.graph, {.max_iterations = 0});
    EXPECT_EQ(kept_edges(ring.graph, start).right, 1.0);
    EXPECT_EQ(kept_edges(ring.graph, start).wrong, 0.0);
    EXPECT_GT(kept_edges(ring.graph, average(ring.graph)).wrong, 0.5);
}

TEST(AverageRotations, StrongEdgesOrALossThatLetsGoKeepTheRingOpen) {
    for (const std::uint32_t nodes : {60U, 114U, 200U}) {
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
            const RotationGraph ring = synthetic::make_folded_ring({.nodes = nodes}, seed).graph;
            const RotationAveragingOptions strong{.weight_power = 2.0,
                                                  .strongest_edges_per_node = 10};
            const RotationAveragingOptions local{.max_iterations = 0, .refine_iterations = 20};
            RotationAveragingOptions consensus = local;
            consensus.consensus_deg = 10.0;
            RotationAveragingOptions again = consensus;
            again.turn_again_factor = 10.0;
            for (const RotationAveragingOptions& options : {strong, local, consensus, again}) {
                const RotationAveraging result = average(ring, options);
                EXPECT_EQ(kept_edges(ring, result).right, 1.0) << nodes;
                EXPECT_EQ(kept_edges(ring, result).wrong, 0.0) << nodes;
            }
        }
    }
}

/// Two sides of a courtyard, each well connected; between them many weaker right edges and three
/// strong wrong ones that agree with one another. quad-streams has this after 144 images.
RotationGraph two_sides(std::uint64_t seed) {
    RotationGraph graph = synthetic::make_random_rotations(
        {.nodes = 30, .density = 0.9, .noise_sigma_deg = 0.5, .outlier_fraction = 0.0}, seed);
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(1.6, Eigen::Vector3d::UnitY()));
    const auto& truth = graph.cam_from_world;
    std::uint32_t wrong = 0;
    for (synthetic::RotationEdge& edge : graph.edges) {
        const std::uint32_t i = index_of(edge.pair.first);
        const std::uint32_t j = index_of(edge.pair.second);
        edge.weight = 300.0 - i;
        if ((i < 15) == (j < 15)) continue;
        edge.weight = 50.0;
        if (wrong == 3) continue;
        edge.cam2_from_cam1 = truth[j] * turned * truth[i].conjugate();
        edge.weight = 110.0;
        edge.truth = RotationEdgeTruth::kConsistent;
        ++wrong;
    }
    return graph;
}

TEST(AverageRotations, ManyWeakerEdgesOutvoteAStrongOne) {
    const RotationAveragingOptions tree{.max_iterations = 0, .refine_iterations = 20};
    RotationAveragingOptions consensus = tree;
    consensus.consensus_deg = 10.0;
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const RotationGraph graph = two_sides(seed);
        EXPECT_EQ(kept_edges(graph, average(graph, tree)).wrong, 1.0);
        for (const double turn_again_factor : {0.0, 10.0}) {
            consensus.turn_again_factor = turn_again_factor;
            const RotationAveraging result = average(graph, consensus);
            EXPECT_EQ(kept_edges(graph, result).wrong, 0.0);
            EXPECT_EQ(kept_edges(graph, result).right, 1.0);
            EXPECT_LT(max_rotation_error_deg(result.node_from_reference, graph.cam_from_world),
                      1.0);
        }
    }
}

/// Three images that are joined first, and to the others at first by one edge: the strongest one
/// around them. Theirs to all others are weaker, and come when it is decided. ioniq5 has this with
/// the reflection of one image in another one.
/// @param others  weight of those
RotationGraph three_and_the_others(std::uint64_t seed, double others, bool strongest_is_right) {
    RotationGraph graph = synthetic::make_random_rotations(
        {.nodes = 12, .density = 1.0, .noise_sigma_deg = 0.5, .outlier_fraction = 0.0}, seed);
    const auto& truth = graph.cam_from_world;
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY()));
    for (synthetic::RotationEdge& edge : graph.edges) {
        const std::uint32_t i = index_of(edge.pair.first);
        const std::uint32_t j = index_of(edge.pair.second);
        const bool is_across = i < 3 && j >= 3;
        const bool is_strongest = i == 2 && j == 3;
        edge.weight = !is_across ? (i < 3 ? 400.0 : 150.0) : is_strongest ? 220.0 : others;
        if (is_across && is_strongest != strongest_is_right) {
            edge.cam2_from_cam1 = truth[j] * turned * truth[i].conjugate();
            edge.truth = RotationEdgeTruth::kConsistent;
        }
    }
    return graph;
}

TEST(AverageRotations, APartThatOneStrongEdgeTurnedIsAskedAgainWhenAllIsJoined) {
    RotationAveragingOptions options{
        .consensus_deg = 10.0, .max_iterations = 0, .refine_iterations = 20};
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const RotationGraph graph = three_and_the_others(seed, 100.0, false);
        options.turn_again_factor = 0.0;
        EXPECT_EQ(kept_edges(graph, average(graph, options)).wrong, 1.0) << seed;
        options.turn_again_factor = 10.0;
        const RotationAveraging result = average(graph, options);
        EXPECT_EQ(kept_edges(graph, result).wrong, 0.0) << seed;
        EXPECT_EQ(kept_edges(graph, result).right, 1.0) << seed;
    }
}

TEST(AverageRotations, WeakEdgesThatAgreeTurnNoPartThatOneStrongEdgeHolds) {
    const RotationAveragingOptions options{.consensus_deg = 10.0,
                                           .turn_again_factor = 10.0,
                                           .max_iterations = 0,
                                           .refine_iterations = 0};
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const RotationGraph graph = three_and_the_others(seed, 20.0, true);
        const RotationAveraging result = average(graph, options);
        EXPECT_EQ(kept_edges(graph, result).wrong, 0.0) << seed;
        EXPECT_EQ(kept_edges(graph, result).right, 1.0) << seed;
    }
}

TEST(AverageRotations, ConsensusGivesComponentsTheirSmallestNodeAsReference) {
    RotationGraph graph = two_sides(1);
    std::erase_if(graph.edges, [](const synthetic::RotationEdge& edge) {
        return (index_of(edge.pair.first) < 15) != (index_of(edge.pair.second) < 15);
    });
    graph.cam_from_world.push_back(Eigen::Quaterniond::Identity());  // without edges
    const RotationAveraging result =
        average(graph, {.consensus_deg = 10.0, .max_iterations = 0, .refine_iterations = 20});
    ASSERT_EQ(result.component_count, 3U);
    for (const std::uint32_t reference : {0U, 15U, 30U}) {
        EXPECT_LT(
            result.node_from_reference[reference].angularDistance(Eigen::Quaterniond::Identity()),
            1e-12);
    }
    for (std::uint32_t node = 0; node < 31; ++node)
        EXPECT_EQ(result.component[node], node < 15 ? 0U : node < 30 ? 1U : 2U);
    EXPECT_EQ(kept_edges(graph, result).right, 1.0);
}

TEST(AverageRotations, RefinementKeepsOutliersOutWithEveryLoss) {
    const RotationGraph graph = synthetic::make_random_rotations(
        {.nodes = 60, .density = 0.4, .noise_sigma_deg = 1.0, .outlier_fraction = 0.2}, 4);
    for (const RotationLoss loss : {RotationLoss::kL12, RotationLoss::kHuber, RotationLoss::kCauchy,
                                    RotationLoss::kGemanMcClure}) {
        RotationAveragingOptions options{.refine_iterations = 30};
        options.loss = loss;
        const RotationAveraging result = average(graph, options);
        EXPECT_LT(max_rotation_error_deg(result.node_from_reference, graph.cam_from_world), 1.5)
            << static_cast<int>(loss);
        EXPECT_EQ(kept_edges(graph, result).wrong, 0.0);
    }
}

TEST(AverageRotations, DoesNotDependOnListingDirectionOrNames) {
    const RotationGraph graph = synthetic::make_random_rotations(
        {.nodes = 40, .density = 0.4, .noise_sigma_deg = 1.0, .outlier_fraction = 0.1}, 5);
    RotationAveragingOptions fine{
        .max_iterations = 100, .convergence_deg = 1e-4, .max_solver_iterations = 1000};
    for (const double consensus_deg : {0.0, 10.0}) {
        fine.consensus_deg = consensus_deg;
        const RotationAveraging expected = average(graph, fine);
        synthetic::Rng rng(6);
        const std::vector<std::size_t> name = synthetic::random_order(40, 7);
        std::vector<RelativeRotation> edges = edges_of(graph);
        std::vector<Eigen::Quaterniond> renamed(40);
        for (RelativeRotation& edge : edges) {
            edge.i = static_cast<std::uint32_t>(name[edge.i]);
            edge.j = static_cast<std::uint32_t>(name[edge.j]);
            if (rng.below(2) == 0) {
                std::swap(edge.i, edge.j);
                edge.j_from_i = edge.j_from_i.conjugate();
            }
            edge.j_from_i.coeffs() *= rng.below(2) == 0 ? -1.0 : 1.0;
        }
        rng.shuffle(edges);
        auto result = average_rotations(edges, 40, fine);
        ASSERT_TRUE(result.ok());
        for (std::size_t k = 0; k < 40; ++k) renamed[k] = result->node_from_reference[name[k]];
        EXPECT_LT(max_rotation_error_deg(renamed, expected.node_from_reference), 0.01);
    }
}

TEST(AverageRotations, IsBitwiseRepeatable) {
    const RotationGraph graph = synthetic::make_random_rotations({.nodes = 50}, 8);
    const RotationAveragingOptions options{.consensus_deg = 10.0, .refine_iterations = 5};
    const RotationAveraging first = average(graph, options);
    const RotationAveraging second = average(graph, options);
    EXPECT_EQ(first.residual_deg, second.residual_deg);
    for (std::size_t k = 0; k < first.node_from_reference.size(); ++k) {
        EXPECT_EQ(first.node_from_reference[k].coeffs(), second.node_from_reference[k].coeffs());
    }
}

TEST(AverageRotations, TakesComponentsOneByOne) {
    RotationGraph graph = synthetic::make_random_rotations(
        {.nodes = 20, .density = 0.3, .noise_sigma_deg = 0.0, .outlier_fraction = 0.0}, 9);
    const auto apart = [](const synthetic::RotationEdge& edge) {
        return (index_of(edge.pair.first) < 10) != (index_of(edge.pair.second) < 10);
    };
    std::erase_if(graph.edges, apart);
    graph.cam_from_world.push_back(Eigen::Quaterniond::Identity());  // without edges
    const RotationAveraging result = average(graph);
    ASSERT_GE(result.component_count, 3U);
    EXPECT_EQ(result.component.back(), result.component_count - 1);
    EXPECT_EQ(result.component.front(), 0U);
    EXPECT_LT(*std::ranges::max_element(result.residual_deg), 1e-6);
    EXPECT_EQ(edges_within(result, 1.0).size(), graph.edges.size());
}

TEST(AverageRotations, TakesSeveralEdgesBetweenTwoNodes) {
    const Eigen::Quaterniond right(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()));
    const Eigen::Quaterniond wrong(Eigen::AngleAxisd(1.3, Eigen::Vector3d::UnitX()));
    const std::vector<RelativeRotation> edges{
        {0, 1, right, 10.0}, {0, 1, wrong, 15.0}, {1, 0, right.conjugate(), 10.0}};
    auto result = average_rotations(edges, 2, {});
    ASSERT_TRUE(result.ok());
    EXPECT_EQ(edges_within(*result, 1.0), (std::vector<std::uint32_t>{0, 2}));
    EXPECT_GT(result->start_residual_deg[0], 50.0);
}

TEST(AverageRotations, NothingGivesNothing) {
    auto result = average_rotations({}, 0, {});
    ASSERT_TRUE(result.ok());
    EXPECT_EQ(result->component_count, 0U);
    EXPECT_TRUE(edges_within(*result, 180.0).empty());
}

TEST(AverageRotations, RefusesBadInput) {
    const auto code = [](const RelativeRotation& edge,
                         const RotationAveragingOptions& options = {}) {
        auto result = average_rotations(std::vector{edge}, 2, options);
        return result.ok() ? ErrorCode::kInternal : result.error().code;
    };
    const Eigen::Quaterniond id = Eigen::Quaterniond::Identity();
    constexpr ErrorCode kInvalid = ErrorCode::kInvalidArgument;
    EXPECT_EQ(code({0, 1, id, 1.0}), ErrorCode::kInternal);  // stands for success
    EXPECT_EQ(code({1, 1, id, 1.0}), kInvalid);
    EXPECT_EQ(code({0, 2, id, 1.0}), kInvalid);
    EXPECT_EQ(code({0, 1, id, 0.0}), kInvalid);
    EXPECT_EQ(code({0, 1, id, -1.0}), kInvalid);
    EXPECT_EQ(code({0, 1, id, std::nan("")}), kInvalid);
    EXPECT_EQ(code({0, 1, Eigen::Quaterniond(0, 0, 0, 0), 1.0}), kInvalid);
    EXPECT_EQ(code({0, 1, Eigen::Quaterniond(std::nan(""), 0, 0, 0), 1.0}), kInvalid);
    EXPECT_EQ(code({0, 1, id, 1.0}, {.weight_power = -1.0}), kInvalid);
    EXPECT_EQ(code({0, 1, id, 1.0}, {.convergence_deg = 0.0}), kInvalid);
    EXPECT_EQ(code({0, 1, id, 1.0}, {.max_solver_iterations = 0}), kInvalid);
    EXPECT_EQ(code({0, 1, id, 1.0}, {.loss_scale_deg = 0.0}), kInvalid);
}

}  // namespace
}  // namespace psfm
