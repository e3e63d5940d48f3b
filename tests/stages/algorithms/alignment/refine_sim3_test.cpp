// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/refine_sim3.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/stages/merge/cut_scene.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/scene.h"

namespace psfm {
namespace {

constexpr double kMaxError = 0.005;

/// Two images of either model look at the same points from some distance.
struct TwoModels {
    Sim3 b_from_a{2.5,
                  Eigen::Quaterniond(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized())),
                  Eigen::Vector3d(4.0, -7.0, 30.0)};
    std::vector<EdgeCorrespondences> edges;

    /// @param noise  standard deviation of b's points, in parts of their distance
    explicit TwoModels(double noise) {
        synthetic::Rng rng(7);
        const auto centred = [&](double size) {
            return Eigen::Vector3d(rng.uniform(-size, size), rng.uniform(-size, size),
                                   rng.uniform(-size, size));
        };
        for (int e = 0; e < 4; ++e) {
            EdgeCorrespondences edge;
            edge.view_a = {synthetic::look_at(Eigen::Vector3d(e, 0, -9), Eigen::Vector3d::Zero()),
                           0.9};
            const Rigid3 same = synthetic::look_at(Eigen::Vector3d(e, 3, -8), centred(0.5));
            edge.view_b = {transform_pose(same, b_from_a), 1.1};
            for (int p = 0; p < 40; ++p) {
                const Eigen::Vector3d in_a = centred(3.0);
                const double spread = noise * 9.0 * b_from_a.scale;
                edge.points.push_back({in_a, b_from_a * in_a + centred(spread)});
            }
            edges.push_back(std::move(edge));
        }
    }

    double cost(const Sim3& similarity) const {
        const double delta = kMaxError / 3.0;
        const Sim3 back = inverse(similarity);
        const auto projected = [](const EdgeView& view, const Eigen::Vector3d& point) {
            const Eigen::Vector3d in_cam = view.cam_from_cluster * point;
            return Eigen::Vector2d(view.focal * in_cam.head<2>() / in_cam.z());
        };
        double sum = 0.0;
        for (const EdgeCorrespondences& edge : edges) {
            for (const PointCorrespondence& point : edge.points) {
                const double squared =
                    (projected(edge.view_a, back * point.in_b) - projected(edge.view_a, point.in_a))
                        .squaredNorm() +
                    (projected(edge.view_b, similarity * point.in_a) -
                     projected(edge.view_b, point.in_b))
                        .squaredNorm();
                const double length = std::sqrt(squared);
                sum += length > delta ? delta * (length - 0.5 * delta) : 0.5 * squared;
            }
        }
        return sum;
    }
};

Sim3 slightly_off(const Sim3& similarity) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(4e-4, Eigen::Vector3d::UnitY()));
    return {1.0005 * similarity.scale, turn * similarity.rotation,
            similarity.translation + Eigen::Vector3d(0.004, -0.003, 0.005)};
}

TEST(RefineSim3, FindsTheSimilarityOfExactPoints) {
    const TwoModels models(0.0);
    const Sim3 start = slightly_off(models.b_from_a);
    ASSERT_GT(test::difference(start, models.b_from_a), 1e-4);
    const Sim3 refined = refine_sim3(models.edges, start, {.max_error = kMaxError});
    EXPECT_LT(test::difference(refined, models.b_from_a), 1e-9);
}

TEST(RefineSim3, NoStepInAnyDirectionIsBetter) {
    const TwoModels models(1e-3);
    const Sim3 refined = refine_sim3(models.edges, models.b_from_a, {.max_error = kMaxError});
    const double least = models.cost(refined);
    EXPECT_LT(least, models.cost(models.b_from_a));
    for (int direction = 0; direction < 7; ++direction) {
        for (const double step : {-1e-4, 1e-4}) {
            Sim3 other = refined;
            if (direction < 3) {
                // About the middle of the points: a turn about the origin shifts them as well.
                const Eigen::Vector3d middle = refined.translation;
                const Eigen::Quaterniond turn(
                    Eigen::AngleAxisd(step, Eigen::Vector3d::Unit(direction)));
                other.rotation = turn * refined.rotation;
                other.translation = turn * (refined.translation - middle) + middle;
            } else if (direction < 6) {
                other.translation[direction - 3] += step;
            } else {
                other.scale *= 1.0 + step;
            }
            EXPECT_GT(models.cost(other), least) << direction << ' ' << step;
        }
    }
}

TEST(RefineSim3, PointsThatDisagreeHaveNoSay) {
    TwoModels models(0.0);
    for (EdgeCorrespondences& edge : models.edges) {
        for (std::size_t p = 0; p < edge.points.size(); p += 4)
            edge.points[p].in_b += Eigen::Vector3d(3.0, 1.0, 0.0);
    }
    const Sim3 refined =
        refine_sim3(models.edges, slightly_off(models.b_from_a), {.max_error = kMaxError});
    EXPECT_LT(test::difference(refined, models.b_from_a), 1e-9);
}

TEST(RefineSim3, TooFewPointsLeaveTheStart) {
    TwoModels models(0.0);
    models.edges.resize(1);
    models.edges.front().points.resize(2);
    const Sim3 start = slightly_off(models.b_from_a);
    EXPECT_EQ(test::difference(refine_sim3(models.edges, start, {.max_error = kMaxError}), start),
              0.0);
}

}  // namespace
}  // namespace psfm
