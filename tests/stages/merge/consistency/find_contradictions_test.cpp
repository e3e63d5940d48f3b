// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/consistency/find_contradictions.h"

#include <gtest/gtest.h>

#include <functional>

#include "stages/merge/run_merge.h"
#include "tests/stages/reconstruction/two_streets.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

constexpr std::uint32_t kImages = 60;

std::vector<ImageId> images_where(const std::function<bool(std::uint32_t)>& holds) {
    std::vector<ImageId> images;
    for (std::uint32_t i = 0; i < kImages; ++i) {
        if (holds(i)) images.push_back(ImageId{i});
    }
    return images;
}

std::vector<ImageId> street(std::uint32_t first) {
    return images_where([&](std::uint32_t i) { return i % 2 == first; });
}

/// Both streets as clusters of one component.
struct Placed {
    std::vector<Reconstruction> models;
    std::vector<VerifiedPairPtr> edges;
    std::vector<ImagePair> weak;

    explicit Placed(const SyntheticScene& scene) {
        for (const std::uint32_t first : {0U, 1U}) {
            models.push_back(synthetic::true_reconstruction(
                scene, synthetic::random_gauge(7 + first), street(first)));
        }
        for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
            const auto [first, second] = pair->pair;
            if (index_of(first) % 2 != index_of(second) % 2) edges.push_back(pair);
        }
    }

    std::size_t contradictions(const Sim3& shift, const ClusterConstraintOptions& options = {}) {
        const std::vector<PlacedModel> placed{{ClusterId{0}, models.data(), cameras_of(models[0]),
                                               inverse(synthetic::random_gauge(7))},
                                              {ClusterId{1}, &models[1], cameras_of(models[1]),
                                               shift * inverse(synthetic::random_gauge(8))}};
        const std::vector<LinkedModels> links{
            {0, 1, cluster_pair_edges(ClusterId{0}, ClusterId{1}, edges, weak)}};
        return find_contradictions(placed, links, {}, options).pairs.size();
    }
};

Sim3 shifted(double x) {
    Sim3 shift;
    shift.translation.x() = x;
    return shift;
}

TEST(FindContradictions, StreetsWithOneFacadeInCommonCannotStandInOnePlace) {
    Placed streets(two_streets(kImages, 0.3, 1));
    EXPECT_EQ(streets.contradictions({}), 1U);
    EXPECT_EQ(streets.contradictions(shifted(100.0)), 0U) << "they do not meet";
    Sim3 turned;
    turned.rotation = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ());
    EXPECT_EQ(streets.contradictions(turned), 0U) << "where they cross they look elsewhere";
    ClusterConstraintOptions options;
    options.min_unmatched_cameras = 0;
    EXPECT_EQ(streets.contradictions({}, options), 0U) << "switched off";
}

TEST(FindContradictions, ClustersOfOneStreetMayInterleave) {
    Placed one(two_streets(kImages, 1.3, 1));
    EXPECT_EQ(one.contradictions({}), 0U);
    for (const VerifiedPairPtr& edge : one.edges) one.weak.push_back(edge->pair);
    one.edges.clear();
    EXPECT_EQ(one.contradictions({}), 0U) << "weak edges show that they belong there";
    one.weak.clear();
    EXPECT_EQ(one.contradictions({}), 1U) << "nothing would tie them together";
}

TEST(FindContradictions, ASmallClusterOfTheFacadeJoinsOneOfTheStreets) {
    const SyntheticScene scene = two_streets(kImages, 0.4, 1);
    const auto on_facade = [](std::uint32_t i) { return i >= 26 && i < 34; };
    const std::vector<std::vector<ImageId>> members{
        images_where([&](std::uint32_t i) { return i % 2 == 0 && !on_facade(i); }),
        images_where([&](std::uint32_t i) { return i % 2 == 1 && !on_facade(i); }),
        images_where(on_facade)};
    MergeProblem problem;
    std::vector<std::uint32_t> cluster_of(kImages);
    for (std::uint32_t c = 0; c < members.size(); ++c) {
        problem.clusters.push_back(
            {static_cast<ClusterId>(c), 1,
             std::make_shared<const Reconstruction>(
                 synthetic::true_reconstruction(scene, synthetic::random_gauge(c), members[c]))});
        for (const ImageId image : members[c]) cluster_of[index_of(image)] = c;
    }
    // Between the streets themselves no pair is an edge.
    for (const std::uint32_t street_number : {0U, 1U}) {
        std::vector<VerifiedPairPtr> between;
        for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
            const auto [low, high] = std::minmax(cluster_of[index_of(pair->pair.first)],
                                                 cluster_of[index_of(pair->pair.second)]);
            if (low == street_number && high == 2) between.push_back(pair);
        }
        problem.pairs.push_back(cluster_pair_edges(static_cast<ClusterId>(street_number),
                                                   ClusterId{2}, std::move(between)));
    }
    MergeOptions options;
    options.constraint.min_neighborhood_similarity = 0.0;  // as of clusters of hundreds
    const auto apart = run_merge(problem, options);
    ASSERT_TRUE(apart.ok());
    EXPECT_EQ(apart->effective_clusters, 2U);
    EXPECT_NE(apart->placements[0].effective_cluster, apart->placements[1].effective_cluster);
    EXPECT_EQ(apart->dropped, 1U);
    // Had photographs of both matches of their own, they would be one street.
    std::vector<ImagePair> weak;
    for (const ImageId x : members[0]) {
        for (const ImageId y : members[1]) weak.push_back(ImagePair::of(x, y));
    }
    problem.pairs.insert(problem.pairs.begin(),
                         cluster_pair_edges(ClusterId{0}, ClusterId{1}, {}, weak));
    const auto matched = run_merge(problem, options);
    ASSERT_TRUE(matched.ok());
    EXPECT_EQ(matched->effective_clusters, 1U);
    EXPECT_EQ(matched->constraints[0].verdict, ConstraintVerdict::kNoEdges) << "they tie nothing";
    problem.pairs.erase(problem.pairs.begin());
    options.constraint.min_unmatched_cameras = 0;
    EXPECT_EQ(run_merge(problem, options)->effective_clusters, 1U);
}

}  // namespace
}  // namespace psfm
