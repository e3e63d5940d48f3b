// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/verified_pairs.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

#include "tests/synthetic/disturb.h"

namespace psfm::synthetic {
namespace {

/// Largest |x2' M x1| in units of its own gradient (Sampson distance), in whatever units x has.
double worst_epipolar_error(const Eigen::Matrix3d& matrix, const std::vector<Eigen::Vector2d>& x1,
                            const std::vector<Eigen::Vector2d>& x2) {
    double worst = 0.0;
    for (std::size_t i = 0; i < x1.size(); ++i) {
        const Eigen::Vector3d line2 = matrix * x1[i].homogeneous();
        const Eigen::Vector3d line1 = matrix.transpose() * x2[i].homogeneous();
        const double gradient = std::hypot(line1.head<2>().norm(), line2.head<2>().norm());
        worst = std::max(worst, std::abs(line2.dot(x2[i].homogeneous())) / gradient);
    }
    return worst;
}

struct Correspondences {
    std::vector<Eigen::Vector2d> x1, x2;
};

Correspondences correspondences(const SyntheticScene& scene, const VerifiedPair& pair,
                                bool pixels) {
    Correspondences result;
    const auto place = [&](ImageId image, std::uint32_t feature) -> Eigen::Vector2d {
        const Camera& camera = scene.camera_of(image);
        const Eigen::Vector2d x = normalized_from_pixel(
            camera, scene.images[index_of(image)].keypoints[feature].position());
        return pixels ? Eigen::Vector2d((camera.matrix() * x.homogeneous()).head<2>()) : x;
    };
    for (const FeatureMatch& match : pair.geometry.inliers) {
        result.x1.push_back(place(pair.pair.first, match.first));
        result.x2.push_back(place(pair.pair.second, match.second));
    }
    return result;
}

SceneOptions two_camera_options() {
    SceneOptions options = ring_around_sphere(10);
    options.cameras.model = CameraModel::kOpenCv;
    options.cameras.shared = false;
    return options;
}

TEST(MakeVerifiedPairs, CalibratedOnesSatisfyTheirEssentialMatrix) {
    const SyntheticScene scene = make_scene(two_camera_options(), 1);
    const std::vector<VerifiedPairPtr> pairs = make_verified_pairs(scene);
    ASSERT_GE(pairs.size(), 10U);
    for (const VerifiedPairPtr& pair : pairs) {
        const TwoViewGeometry& geometry = pair->geometry;
        EXPECT_EQ(geometry.kind, TwoViewKind::kEssential);
        EXPECT_NEAR(geometry.matrix.norm(), 1.0, 1e-12);
        EXPECT_NEAR(geometry.cam2_from_cam1.translation.norm(), 1.0, 1e-12);
        EXPECT_GE(geometry.inliers.size(), 15U);
        const Correspondences x = correspondences(scene, *pair, false);
        EXPECT_LT(worst_epipolar_error(geometry.matrix, x.x1, x.x2), 1e-6);
        const Rigid3 truth = scene.images[index_of(pair->pair.second)].cam_from_world *
                             inverse(scene.images[index_of(pair->pair.first)].cam_from_world);
        EXPECT_LT(angle_between(truth.rotation, geometry.cam2_from_cam1.rotation), 1e-12);
        EXPECT_NEAR(truth.translation.normalized().dot(geometry.cam2_from_cam1.translation), 1.0,
                    1e-12);
        EXPECT_GT(geometry.median_angle_deg, 1.0);
        EXPECT_LT(geometry.median_angle_deg, 180.0);
    }
}

TEST(MakeVerifiedPairs, UncalibratedOnesSatisfyTheirFundamentalMatrix) {
    const SyntheticScene scene = make_scene(two_camera_options(), 2);
    for (const VerifiedPairPtr& pair : make_verified_pairs(scene, {.calibrated = false})) {
        EXPECT_EQ(pair->geometry.kind, TwoViewKind::kFundamental);
        const Correspondences x = correspondences(scene, *pair, true);
        EXPECT_LT(worst_epipolar_error(pair->geometry.matrix, x.x1, x.x2), 1e-3);
    }
}

TEST(MakeVerifiedPairs, HoldTheTrueMatchesAndNothingElse) {
    const SyntheticScene scene = add_clutter(make_scene(ring_around_sphere(10), 1), 50, 1);
    const std::vector<VerifiedPairPtr> pairs = make_verified_pairs(scene);
    std::size_t next = 0;
    for (std::uint32_t a = 0; a < 10; ++a) {
        for (std::uint32_t b = a + 1; b < 10; ++b) {
            std::vector<FeatureMatch> expected;
            for (std::uint32_t i = 0; i < scene.images[a].feature_point.size(); ++i) {
                for (std::uint32_t j = 0; j < scene.images[b].feature_point.size(); ++j) {
                    const std::uint32_t point = scene.images[a].feature_point[i];
                    if (point != kNoPoint && point == scene.images[b].feature_point[j])
                        expected.push_back({i, j});
                }
            }
            if (expected.size() < 15) continue;
            ASSERT_LT(next, pairs.size());
            EXPECT_EQ(pairs[next]->pair, (ImagePair{ImageId{a}, ImageId{b}}))
                << "ascending by pair";
            EXPECT_EQ(pairs[next]->geometry.inliers, expected);
            ++next;
        }
    }
    EXPECT_EQ(next, pairs.size());
}

TEST(MakeVerifiedPairs, KnowPlanes) {
    SceneOptions options = line_along_wall(6);
    options.points.relief = 0.0;
    const SyntheticScene scene = make_scene(options, 1);
    const std::vector<VerifiedPairPtr> pairs = make_verified_pairs(scene);
    ASSERT_FALSE(pairs.empty());
    for (const VerifiedPairPtr& pair : pairs) {
        ASSERT_EQ(pair->geometry.kind, TwoViewKind::kPlanar);
        EXPECT_NEAR(pair->geometry.cam2_from_cam1.translation.norm(), 1.0, 1e-12);
        const Correspondences x = correspondences(scene, *pair, true);
        for (std::size_t i = 0; i < x.x1.size(); ++i) {
            const Eigen::Vector3d mapped = pair->geometry.matrix * x.x1[i].homogeneous();
            EXPECT_LT((mapped.hnormalized() - x.x2[i]).norm(), 1e-2);
        }
    }
}

TEST(MakeVerifiedPairs, KnowPureRotations) {
    SceneOptions options = ring_in_room(12);
    options.cameras.radius = 0.0;
    options.cameras.shift_sigma = 0.0;
    const SyntheticScene scene = make_scene(options, 1);
    const std::vector<VerifiedPairPtr> pairs = make_verified_pairs(scene);
    ASSERT_FALSE(pairs.empty());
    for (const VerifiedPairPtr& pair : pairs) {
        ASSERT_EQ(pair->geometry.kind, TwoViewKind::kPureRotation);
        EXPECT_EQ(pair->geometry.cam2_from_cam1.translation.norm(), 0.0);
        const Correspondences x = correspondences(scene, *pair, true);
        for (std::size_t i = 0; i < x.x1.size(); ++i) {
            const Eigen::Vector3d mapped = pair->geometry.matrix * x.x1[i].homogeneous();
            EXPECT_LT((mapped.hnormalized() - x.x2[i]).norm(), 1e-2);
        }
    }
}

TEST(MakeViewGraph, WeighsEdgesByInliers) {
    const SyntheticScene scene = make_scene(ring_around_sphere(10), 1);
    const std::vector<VerifiedPairPtr> pairs = make_verified_pairs(scene);
    const ViewGraph graph = make_view_graph(10, pairs);
    EXPECT_EQ(graph.size(), 10U);
    EXPECT_EQ(graph.edge_count(), pairs.size());
    for (const VerifiedPairPtr& pair : pairs) {
        const ViewGraph::Edge* edge = graph.find(pair->pair.first, pair->pair.second);
        ASSERT_NE(edge, nullptr);
        EXPECT_EQ(edge->weight, static_cast<double>(pair->geometry.inliers.size()));
        EXPECT_EQ(edge->pair, pair);
    }
}

}  // namespace
}  // namespace psfm::synthetic
