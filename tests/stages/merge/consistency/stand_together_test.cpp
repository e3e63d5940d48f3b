// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/consistency/stand_together.h"

#include <gtest/gtest.h>

#include "tests/stages/merge/cut_scene.h"
#include "tests/stages/reconstruction/two_streets.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

constexpr std::uint32_t kImages = 40;

/// Steps of 20 cm, 6 m before a wall: some seven images on either side of a cut have companions.
synthetic::SyntheticScene one_street() {
    synthetic::SceneOptions options = synthetic::line_along_wall(kImages);
    options.cameras.radius = 0.1 * kImages;
    options.points.extent.x() = 0.2 * kImages + 8.0;
    return synthetic::make_scene(options, 1);
}

std::vector<ImagePair> pairs_of(const std::vector<VerifiedPairPtr>& edges) {
    std::vector<ImagePair> pairs;
    for (const VerifiedPairPtr& edge : edges) pairs.push_back(edge->pair);
    return pairs;
}

TEST(StandTogether, HalvesOfOneStreet) {
    const test::CutScene scene = test::cut(one_street(), {20, 20}, 2);
    const MergeProblem problem = scene.problem();
    const Reconstruction& a = *problem.clusters[0].model;
    const Reconstruction& b = *problem.clusters[1].model;
    const std::vector<VerifiedPairPtr> edges = scene.edges_between(0, 1);
    EXPECT_TRUE(stand_together(a, b, *cluster_pair_edges(ClusterId{0}, ClusterId{1}, edges), {}));
    EXPECT_FALSE(stand_together(
        a, b, *cluster_pair_edges(ClusterId{0}, ClusterId{1}, {}, pairs_of(edges)), {}))
        << "weak ones alone say nothing of where they stand";
    ClusterConstraintOptions options;
    options.min_unmatched_cameras = 0;
    EXPECT_FALSE(
        stand_together(a, b, *cluster_pair_edges(ClusterId{0}, ClusterId{1}, edges), options))
        << "nothing would tell";
}

TEST(StandTogether, NotPartsThatDoNotMeet) {
    test::CutScene scene = test::cut(one_street(), {14, 12, 14}, 2);
    const MergeProblem problem = scene.problem();
    const std::vector<VerifiedPairPtr> edges = scene.edges_between(0, 2);
    ASSERT_GE(edges.size(), 5U);
    EXPECT_FALSE(stand_together(*problem.clusters[0].model, *problem.clusters[2].model,
                                *cluster_pair_edges(ClusterId{0}, ClusterId{1}, edges), {}))
        << "no camera of either stands beside one of the other";
}

TEST(StandTogether, NotStreetsThatHaveOneFacadeInCommon) {
    const synthetic::SyntheticScene scene = two_streets(kImages, 0.4, 1);
    std::vector<Reconstruction> streets;
    for (const std::uint32_t first : {0U, 1U}) {
        std::vector<ImageId> images;
        for (std::uint32_t i = first; i < kImages; i += 2) images.push_back(ImageId{i});
        streets.push_back(
            synthetic::true_reconstruction(scene, synthetic::random_gauge(first), images));
    }
    std::vector<VerifiedPairPtr> edges;
    for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
        if (index_of(pair->pair.first) % 2 != index_of(pair->pair.second) % 2)
            edges.push_back(pair);
    }
    ClusterConstraintOptions options;
    options.min_neighborhood_similarity = 0.0;  // as of clusters of hundreds
    const auto pairs = cluster_pair_edges(ClusterId{0}, ClusterId{1}, edges);
    EXPECT_FALSE(stand_together(streets[0], streets[1], *pairs, options));
    options.max_unmatched_part = 1.0;
    EXPECT_TRUE(stand_together(streets[0], streets[1], *pairs, options))
        << "only what they do not share says it";
}

}  // namespace
}  // namespace psfm
