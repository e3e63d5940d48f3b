// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/estimate_cluster_constraint.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/stages/merge/cut_scene.h"
#include "tests/synthetic/change_points.h"

namespace psfm {
namespace {

using test::CutScene;

struct Pair {
    Reconstruction a;
    Reconstruction b;
    std::vector<VerifiedPairPtr> edges;

    ClusterConstraint estimate(const ClusterConstraintOptions& options = {},
                               const ClusterConstraint* before = nullptr) const {
        return estimate_cluster_constraint(index(a), index(b), edges, options, before);
    }
    static ClusterIndex index(const Reconstruction& model) {
        std::vector<ImageId> images;
        for (const RegisteredImage& image : model.images) images.push_back(image.image);
        return {model, images};
    }
};

Pair pair_of(const CutScene& cut) {
    return {cut.model(0), cut.model(1), cut.edges_between(0, 1)};
}

Sim3 truth_of(const CutScene& cut) {
    return cut.cluster_from_world[1] * inverse(cut.cluster_from_world[0]);
}

TEST(EstimateClusterConstraint, RecoversTheSimilarity) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const CutScene cut = test::cut_ring({12, 12, 12}, seed);
        const Pair pair = pair_of(cut);
        ASSERT_GT(pair.edges.size(), 2U);
        const ClusterConstraint found = pair.estimate();
        ASSERT_TRUE(found.accepted()) << describe(found.verdict);
        EXPECT_LT(test::difference(found.b_from_a, truth_of(cut)), 1e-6);
        EXPECT_EQ(found.inliers, found.correspondences);
        EXPECT_GT(found.extent_in_a, 0.0);
    }
}

TEST(EstimateClusterConstraint, SurvivesWrongMatches) {
    CutScene cut = test::cut_ring({12, 12, 12}, 2);
    // A wrong match ties a point of one model to any point of the other: partners in a pair are
    // shifted.
    for (VerifiedPairPtr& pointer : cut.pairs) {
        VerifiedPair wrong = *pointer;
        std::vector<FeatureMatch>& matches = wrong.geometry.inliers;
        const std::size_t count = matches.size() / 2;
        if (count < 2) continue;
        const std::uint32_t last = matches[count - 1].second;
        for (std::size_t k = count - 1; k > 0; --k) matches[k].second = matches[k - 1].second;
        matches[0].second = last;
        pointer = std::make_shared<const VerifiedPair>(std::move(wrong));
    }
    const ClusterConstraint found = pair_of(cut).estimate();
    ASSERT_TRUE(found.accepted()) << describe(found.verdict);
    EXPECT_LT(test::difference(found.b_from_a, truth_of(cut)), 1e-3);
    EXPECT_LT(found.inliers, 0.6 * found.correspondences);
}

TEST(EstimateClusterConstraint, ToleratesUncertainDepths) {
    const CutScene cut = test::cut_ring({12, 12}, 3);
    Pair pair = pair_of(cut);
    synthetic::Rng rng(4);
    for (Reconstruction* model : {&pair.a, &pair.b}) {
        synthetic::change_points(*model, [&](std::vector<ScenePoint>& points) {
            for (ScenePoint& point : points) {
                const RegisteredImage& image = *model->find(point.track.front().image);
                const Eigen::Vector3d centre = image.cam_from_cluster.target_origin_in_source();
                point.position += 0.005 * rng.normal() * (point.position - centre);
            }
        });
    }
    const ClusterConstraint found = pair.estimate();
    ASSERT_TRUE(found.accepted()) << describe(found.verdict);
    const Sim3 error = inverse(truth_of(cut)) * found.b_from_a;
    EXPECT_LT(rotation_angle(error.rotation), 0.01);
    EXPECT_NEAR(error.scale, 1.0, 0.01);
}

/// Two halves of a ring that a look-alike lays over each other: the edges say that image k + 12
/// stands where image k does, a little beside it.
TEST(EstimateClusterConstraint, RejectsInterleavedCameras) {
    const synthetic::SyntheticScene scene =
        synthetic::make_scene(synthetic::ring_around_sphere(48), 5);
    CutScene cut = test::cut(scene, {0, 0}, 5);
    for (std::uint32_t i = 0; i < 24; ++i) cut.members[i % 2].push_back(static_cast<ImageId>(i));
    const Pair pair = pair_of(cut);
    const ClusterConstraint found = pair.estimate();
    EXPECT_EQ(found.verdict, ConstraintVerdict::kInterleaved);
    EXPECT_GT(found.edges_tried, 0U);
    EXPECT_EQ(found.edges_accepted, 0U);
    EXPECT_EQ(pair.estimate({.border_cameras = 23}).verdict, ConstraintVerdict::kInterleaved);
    ClusterConstraintOptions lenient;
    lenient.min_neighborhood_similarity = 0.0;
    EXPECT_TRUE(pair.estimate(lenient).accepted());
}

/// Clusters of five side by side: the two cameras at the border are each other's neighbours.
TEST(EstimateClusterConstraint, LetsTheCamerasAtTheBorderBeNeighbours) {
    synthetic::SceneOptions options = synthetic::ring_around_sphere(40);
    options.cameras.shift_sigma = 0.0;
    CutScene cut = test::cut(synthetic::make_scene(options, 9), {0, 0}, 9);
    for (const std::uint32_t i : {0U, 3U, 6U, 9U, 12U}) cut.members[0].push_back(ImageId{i});
    for (const std::uint32_t i : {14U, 17U, 20U, 23U, 26U}) cut.members[1].push_back(ImageId{i});
    const Pair pair = pair_of(cut);
    EXPECT_TRUE(pair.estimate().accepted());
    EXPECT_EQ(pair.estimate({.border_cameras = 0}).verdict, ConstraintVerdict::kInterleaved);
}

TEST(EstimateClusterConstraint, SaysWhyNot) {
    const CutScene cut = test::cut_ring({12, 12}, 6);
    Pair pair = pair_of(cut);
    EXPECT_EQ(Pair({pair.a, pair.b, {}}).estimate().verdict, ConstraintVerdict::kNoEdges);
    Pair without_points = pair;
    without_points.a.points = {};
    EXPECT_EQ(without_points.estimate().verdict, ConstraintVerdict::kNoEdges);
    // Points that agree on nothing.
    Pair shaken = pair;
    synthetic::Rng rng(7);
    std::vector<Eigen::Vector3d> positions;
    for (const ScenePoint& point : shaken.b.points) positions.push_back(point.position);
    rng.shuffle(positions);
    synthetic::change_points(shaken.b, [&](std::vector<ScenePoint>& points) {
        for (std::size_t k = 0; k < positions.size(); ++k) points[k].position = positions[k];
    });
    EXPECT_EQ(shaken.estimate().verdict, ConstraintVerdict::kNoSimilarity);
    ClusterConstraintOptions strict;
    strict.min_pair_inliers = 1000000;
    EXPECT_EQ(pair.estimate(strict).verdict, ConstraintVerdict::kInconsistent);
}

TEST(EstimateClusterConstraint, IsTheSameEitherWayRoundAndEveryTime) {
    const CutScene cut = test::cut_ring({12, 12}, 8);
    const Pair pair = pair_of(cut);
    const ClusterConstraint first = pair.estimate();
    const ClusterConstraint again = pair.estimate();
    EXPECT_EQ(first.b_from_a.rotation.coeffs(), again.b_from_a.rotation.coeffs());
    EXPECT_EQ(first.b_from_a.translation, again.b_from_a.translation);
    const ClusterConstraint back = Pair{pair.b, pair.a, pair.edges}.estimate();
    EXPECT_LT(test::difference(inverse(back.b_from_a), first.b_from_a), 1e-6);
    EXPECT_EQ(back.inliers, first.inliers);
}

void expect_equal(const ClusterConstraint& x, const ClusterConstraint& y) {
    EXPECT_EQ(x.verdict, y.verdict);
    EXPECT_EQ(x.edges_tried, y.edges_tried);
    EXPECT_EQ(x.edges_accepted, y.edges_accepted);
    EXPECT_EQ(x.correspondences, y.correspondences);
    EXPECT_EQ(x.inliers, y.inliers);
    EXPECT_EQ(x.b_from_a.rotation.coeffs(), y.b_from_a.rotation.coeffs());
    EXPECT_EQ(x.b_from_a.translation, y.b_from_a.translation);
    EXPECT_EQ(x.b_from_a.scale, y.b_from_a.scale);
    EXPECT_EQ(x.anchor_in_a, y.anchor_in_a);
    EXPECT_EQ(x.extent_in_a, y.extent_in_a);
}

/// Whatever changes in either model or among the edges, with and without an earlier estimate come
/// to the same to the bit.
TEST(EstimateClusterConstraint, WhatIsTakenOverIsWhatWouldBeEstimated) {
    Pair pair = pair_of(test::cut_ring({14, 14}, 11));
    const Pair original = pair;
    ClusterConstraint before = pair.estimate();
    ASSERT_TRUE(before.accepted());
    EXPECT_EQ(before.edges_estimated, before.edges_tried);
    synthetic::Rng rng(12);
    std::uint32_t taken_over = 0;
    for (int change = 0; change < 40; ++change) {
        Reconstruction& model = rng.below(2) == 0 ? pair.a : pair.b;
        switch (rng.below(5)) {
            case 0:  // one point moves
                synthetic::change_points(model, [&](std::vector<ScenePoint>& points) {
                    points[rng.below(points.size())].position += 0.01 * rng.normal3();
                });
                break;
            case 1:  // one camera turns
                model.images[rng.below(model.images.size())].cam_from_cluster.rotation *=
                    Eigen::Quaterniond(Eigen::AngleAxisd(0.001, rng.normal3().normalized()));
                break;
            case 2:  // one edge goes
                if (pair.edges.size() > 4)
                    pair.edges.erase(pair.edges.begin() +
                                     static_cast<std::ptrdiff_t>(rng.below(pair.edges.size())));
                break;
            case 3:  // a focal length is known better
                model.cameras.begin()->second.params[0] *= 1.0001;
                break;
            case 4:  // all as in the beginning
                pair = original;
                break;
        }
        const ClusterConstraint fresh = pair.estimate();
        const ClusterConstraint again = pair.estimate({}, &before);
        SCOPED_TRACE(change);
        expect_equal(again, fresh);
        EXPECT_EQ(fresh.edges_estimated, fresh.edges_tried);
        EXPECT_LE(again.edges_estimated, again.edges_tried);
        taken_over += again.edges_tried - again.edges_estimated;
        before = again;
    }
    EXPECT_GT(taken_over, 0U);
}

/// A model of hundreds of images that is extended at its far end.
TEST(EstimateClusterConstraint, ChangesElsewhereCostNothing) {
    Pair pair = pair_of(test::cut_ring({40, 40}, 13));
    std::erase_if(pair.edges, [](const VerifiedPairPtr& edge) {
        return index_of(edge->pair.first) < 34 || index_of(edge->pair.second) >= 46;
    });
    const ClusterConstraint before = pair.estimate();
    ASSERT_TRUE(before.accepted());
    // Images that no edge leads to.
    std::vector<ImageId> at_border;
    for (const VerifiedPairPtr& edge : pair.edges) {
        at_border.push_back(edge->pair.first);
        at_border.push_back(edge->pair.second);
    }
    int moved = 0;
    for (RegisteredImage& image : pair.a.images) {
        if (std::ranges::find(at_border, image.image) != at_border.end()) continue;
        image.cam_from_cluster.translation += Eigen::Vector3d::Constant(1e-4);
        ++moved;
    }
    ASSERT_GT(moved, 0);
    const ClusterConstraint again = pair.estimate({}, &before);
    EXPECT_EQ(again.edges_estimated, 0U);
    expect_equal(again, before);
}

/// The similarities stay, but cameras of one cluster have come to stand among those of the other.
TEST(EstimateClusterConstraint, WhetherCamerasInterleaveIsAlwaysLookedAt) {
    const CutScene cut = test::cut_ring({12, 12, 12}, 14);
    Pair pair = pair_of(cut);
    const ClusterConstraint before = pair.estimate();
    ASSERT_TRUE(before.accepted());
    const Sim3 b_from_a = truth_of(cut);
    std::uint32_t image = 1000;
    for (const RegisteredImage& other : cut.model(1).images) {
        RegisteredImage beside = other;
        beside.image = ImageId{image++};
        beside.cam_from_cluster = transform_pose(other.cam_from_cluster, inverse(b_from_a));
        beside.cam_from_cluster.translation += Eigen::Vector3d(1e-3, 0, 0);
        pair.a.images.push_back(beside);
    }
    const ClusterConstraint again = pair.estimate({}, &before);
    EXPECT_EQ(again.edges_estimated, 0U);
    EXPECT_EQ(again.verdict, ConstraintVerdict::kInterleaved);
    expect_equal(again, pair.estimate());
}

}  // namespace
}  // namespace psfm
