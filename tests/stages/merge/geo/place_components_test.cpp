// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// What positions and gravity do to the frames that run_merge publishes.
#include "stages/merge/geo/place_components.h"

#include <gtest/gtest.h>

#include <GeographicLib/LocalCartesian.hpp>

#include "stages/merge/geo/keep_frame.h"
#include "stages/merge/geo/world_reference.h"
#include "tests/stages/merge/cut_scene.h"

namespace psfm {
namespace {

using test::CutScene;

constexpr double kLatitude = 55.7;
constexpr double kLongitude = 13.2;

MergeResult merged(const MergeProblem& problem, const MergeOptions& options = {}) {
    auto result = run_merge(problem, options);
    EXPECT_TRUE(result.ok()) << result.error().message;
    return result.ok() ? *result : MergeResult{};
}

/// A ring of cameras around a sphere, cut in two parts without an edge between them. Its radius is
/// 8 m, so positions are good to decimetres here.
class PlaceComponents : public testing::Test {
  protected:
    PlaceComponents() {
        options.georeference.horizontal_sigma_m = 0.3;
        options.georeference.vertical_sigma_m = 0.6;
    }

    Eigen::Vector3d centre(std::size_t image) const {
        return cut.scene.images[image].cam_from_world.target_origin_in_source();
    }

    /// Positions of images first … end - 1, with noise, in an east-north-up frame about camera 0.
    std::vector<ImageEvidence> evidence(std::size_t first, std::size_t end) const {
        std::mt19937_64 random(11);
        std::normal_distribution<double> normal(0.0, options.georeference.horizontal_sigma_m);
        const GeographicLib::LocalCartesian frame(kLatitude, kLongitude, 50.0);
        std::vector<ImageEvidence> result;
        for (std::size_t k = 0; k < cut.scene.images.size(); ++k) {
            const Eigen::Vector3d noise(normal(random), normal(random), normal(random));
            const Eigen::Vector3d enu = centre(k) + noise;
            ImageEvidence image{static_cast<ImageId>(k), std::nullopt, 1};
            if (k >= first && k < end) {
                GpsPosition position;
                double altitude = 0.0;
                frame.Reverse(enu.x(), enu.y(), enu.z(), position.latitude_deg,
                              position.longitude_deg, altitude);
                position.altitude_m = altitude;
                image.gps = position;
            }
            result.push_back(image);
        }
        return result;
    }

    MergeProblem apart() const {
        MergeProblem problem = cut.problem();
        problem.pairs.clear();
        return problem;
    }

    Eigen::Vector3d placed(const MergeResult& result, std::size_t image) const {
        const std::size_t c = image < cut.members[0].size() ? 0 : 1;
        return result.placements[c].world_from_cluster *
               (cut.cluster_from_world[c] * centre(image));
    }

    Eigen::Vector3d up(const MergeResult& result, std::size_t cluster) const {
        return result.placements[cluster].world_from_cluster.rotation *
               (cut.cluster_from_world[cluster].rotation * Eigen::Vector3d::UnitZ());
    }

    double largest_move(const MergeResult& from, const MergeResult& to) const {
        double largest = 0.0;
        for (std::size_t k = 0; k < cut.scene.images.size(); ++k)
            largest = std::max(largest, (placed(from, k) - placed(to, k)).norm());
        return largest;
    }

    CutScene cut = test::cut_ring({20, 22}, 12);
    MergeOptions options;
};

TEST_F(PlaceComponents, UnconnectedPartsStandInRelation) {
    MergeProblem problem = apart();
    problem.evidence = evidence(0, 42);
    const MergeResult result = merged(problem, options);
    EXPECT_EQ(result.effective_clusters, 2U);
    ASSERT_TRUE(result.datum);
    EXPECT_EQ(*result.datum, *problem.evidence[0].gps);
    const Eigen::Vector3d datum = placed(result, 0) - centre(0);
    for (std::size_t k = 0; k < 42; ++k)
        EXPECT_LT((placed(result, k) - centre(k) - datum).norm(), 0.6) << k;
    for (const ComponentPlace& place : result.places) {
        EXPECT_EQ(place.source, FrameSource::kPositions);
        EXPECT_LT(place.agreement.median_m, 0.6);
    }
    // And a reader of that version finds out.
    std::vector<std::vector<CameraCentre>> models(2);
    for (std::size_t k = 0; k < 42; ++k)
        models[k < 20 ? 0 : 1].push_back({static_cast<ImageId>(k), placed(result, k)});
    const auto reference = world_reference(models, problem.evidence, options.georeference);
    ASSERT_TRUE(reference);
    EXPECT_EQ(reference->datum, *result.datum);
    for (auto& model : models) {
        for (CameraCentre& camera : model) camera.in_world.x() += 10.0;
    }
    EXPECT_FALSE(world_reference(models, problem.evidence, options.georeference));
}

/// The second part is cameras 20 to 41.
TEST_F(PlaceComponents, WhatComesBackStandsWhereTheModelHadItThatASessionBeganWith) {
    MergeProblem problem = apart();
    const auto anchor = [&](std::uint32_t image) {
        return WorldAnchor{ImageId{image}, cut.scene.images[image].cam_from_world};
    };
    problem.anchors = {anchor(5), anchor(9), anchor(20)};
    const MergeResult first = merged(problem);
    for (std::size_t k = 0; k < 20; ++k) EXPECT_LT((placed(first, k) - centre(k)).norm(), 1e-6);
    EXPECT_GT((placed(first, 30) - centre(30)).norm(), 0.1) << "one anchor gives no scale";

    // A part that was published without its anchors moves to them, one that had them stays.
    problem.previous = test::publish(problem, first);
    problem.anchors = {anchor(5), anchor(9)};
    for (WorldAnchor& moved : problem.anchors) moved.cam_from_world.translation.x() += 1.0;
    EXPECT_LT(largest_move(first, merged(problem)), 1e-6);
    auto without = std::make_shared<Scene>(*problem.previous);
    without->clusters.erase(without->clusters.begin());
    problem.previous = without;
    problem.anchors = {anchor(20), anchor(31)};
    EXPECT_LT((placed(merged(problem), 30) - placed(first, 30)).norm(), 1e-6);
    problem.anchors = {anchor(5), anchor(9)};
    const MergeResult again = merged(problem);
    for (std::size_t k = 0; k < 20; ++k) EXPECT_LT((placed(again, k) - centre(k)).norm(), 1e-6);
}

TEST_F(PlaceComponents, ALargerPartThatJoinsComesIntoTheWorldThatTheSessionBeganWith) {
    MergeProblem problem = apart();
    problem.anchors = {{ImageId{5}, cut.scene.images[5].cam_from_world},
                       {ImageId{9}, cut.scene.images[9].cam_from_world}};
    MergeProblem joined = cut.problem();
    joined.previous = test::publish(problem, merged(problem));
    EXPECT_GT((placed(merged(joined), 0) - centre(0)).norm(), 0.1) << "22 cameras outvote 20";
    joined.anchors = problem.anchors;
    const MergeResult result = merged(joined);
    EXPECT_EQ(result.effective_clusters, 1U);
    for (std::size_t k = 0; k < 42; ++k) EXPECT_LT((placed(result, k) - centre(k)).norm(), 0.05);
}

TEST_F(PlaceComponents, WithoutPositionsNothingChanges) {
    const MergeResult plain = merged(apart());
    MergeProblem problem = apart();
    problem.evidence = evidence(0, 0);  // orientations only
    const MergeResult oriented = merged(problem);
    problem.evidence = evidence(0, 42);
    options.use_gps = false;
    const MergeResult off = merged(problem, options);
    options.use_gps = true;
    problem.evidence = evidence(0, 2);  // too few
    const MergeResult few = merged(problem, options);
    for (const MergeResult* result : {&oriented, &off, &few}) {
        EXPECT_FALSE(result->datum);
        for (std::size_t c = 0; c < 2; ++c) {
            const Sim3& x = plain.placements[c].world_from_cluster;
            const Sim3& y = result->placements[c].world_from_cluster;
            EXPECT_EQ(x.scale, y.scale);
            EXPECT_EQ(x.rotation.coeffs(), y.rotation.coeffs());
            EXPECT_EQ(x.translation, y.translation);
        }
    }
}

TEST_F(PlaceComponents, TheSameEvidenceMovesNothing) {
    MergeProblem problem = apart();
    problem.evidence = evidence(0, 42);
    const MergeResult first = merged(problem, options);
    problem.previous = test::publish(problem, first);
    const MergeResult second = merged(problem, options);
    for (std::size_t c = 0; c < 2; ++c) {
        const Sim3& x = first.placements[c].world_from_cluster;
        const Sim3& y = second.placements[c].world_from_cluster;
        EXPECT_LT((x.translation - y.translation).norm(), 1e-9);
        EXPECT_LT(angle_between(x.rotation, y.rotation), 1e-7);
    }
}

TEST_F(PlaceComponents, TheFrameFollowsTheEvidenceAndNotMore) {
    MergeResult before;
    int moves = 0;
    for (std::size_t count = 4; count <= 20; ++count) {
        MergeProblem problem = apart();
        problem.evidence = evidence(0, count);
        MergeProblem alone = problem;  // what the evidence says, whatever was published
        const MergeResult now = merged(alone, options);
        ASSERT_TRUE(now.datum) << count;
        if (count > 4) {
            problem.previous = test::publish(problem, before);
            const MergeResult next = merged(problem, options);
            const double error =
                options.georeference.horizontal_sigma_m / std::sqrt(static_cast<double>(count));
            double step = 0.0;  // of the part with positions, root mean square
            double to_evidence = 0.0;
            for (std::size_t k = 0; k < 20; ++k) {
                step += (placed(next, k) - placed(before, k)).squaredNorm() / 20.0;
                to_evidence += (placed(next, k) - placed(now, k)).squaredNorm() / 20.0;
            }
            // Where the evidence has it, up to what that is worth (with few positions the robust
            // cost has several minima), and steps are no longer than both errors together.
            EXPECT_LT(std::sqrt(to_evidence), 2.5 * error) << count;
            EXPECT_LT(std::sqrt(step), 5.0 * error) << count;
            if (std::sqrt(step) >= 1e-9) ++moves;
            before = next;
        } else {
            before = now;
        }
    }
    EXPECT_GT(moves, 0);
    EXPECT_LT(moves, 10);  // of 16
}

TEST_F(PlaceComponents, APartWithoutPositionsIsTurnedUprightInItsPlace) {
    MergeProblem problem = apart();
    const MergeResult before = merged(problem);
    problem.previous = test::publish(problem, before);
    problem.evidence = evidence(0, 20);
    const MergeResult after = merged(problem, options);
    ASSERT_TRUE(after.datum);
    EXPECT_EQ(after.places[after.placements[0].effective_cluster].source, FrameSource::kPositions);
    EXPECT_EQ(after.places[after.placements[1].effective_cluster].source, FrameSource::kGravity);
    Eigen::Vector3d was = Eigen::Vector3d::Zero();
    Eigen::Vector3d is = Eigen::Vector3d::Zero();
    for (std::size_t k = 20; k < 42; ++k) {
        was += placed(before, k) / 22.0;
        is += placed(after, k) / 22.0;
    }
    EXPECT_LT((was - is).norm(), 1e-6);
    EXPECT_LT(up(before, 1).z(), 0.95);  // or this shows nothing
    EXPECT_GT(up(after, 1).z(), std::cos(4.0 * std::numbers::pi / 180.0));
    EXPECT_NEAR(before.placements[1].world_from_cluster.scale,
                after.placements[1].world_from_cluster.scale, 1e-9);
    // Once upright it stays, but for rounding.
    problem.previous = test::publish(problem, after);
    EXPECT_LT(largest_move(after, merged(problem, options)), 1e-9);
    // Without gravity it stays as it was, and the other part, a ring, needs none.
    options.use_gravity = false;
    problem.previous = test::publish(problem, before);
    const MergeResult level = merged(problem, options);
    EXPECT_TRUE(level.datum);
    EXPECT_LT(test::difference(level.placements[1].world_from_cluster,
                               before.placements[1].world_from_cluster),
              1e-9);
}

TEST_F(PlaceComponents, TooFewPositionsStillTellWhereAbouts) {
    MergeProblem problem = apart();
    problem.evidence = evidence(0, 22);  // two in the second part
    const MergeResult result = merged(problem, options);
    EXPECT_EQ(result.places[result.placements[1].effective_cluster].source,
              FrameSource::kWhereabouts);
    EXPECT_GT(up(result, 1).z(), std::cos(4.0 * std::numbers::pi / 180.0));
    const Eigen::Vector3d datum = placed(result, 0) - centre(0);
    const Eigen::Vector3d middle = 0.5 * (placed(result, 20) + placed(result, 21));
    EXPECT_LT((middle - datum - 0.5 * (centre(20) + centre(21))).norm(), 2.0);
    // There it stays.
    problem.previous = test::publish(problem, result);
    EXPECT_LT(largest_move(result, merged(problem, options)), 1e-9);
}

TEST_F(PlaceComponents, APartThatLosesItsPositionsStays) {
    MergeProblem problem = apart();
    problem.evidence = evidence(0, 42);
    const MergeResult before = merged(problem, options);
    problem.previous = test::publish(problem, before);
    problem.evidence = evidence(0, 22);  // two are left to the second part
    const MergeResult after = merged(problem, options);
    ASSERT_TRUE(after.datum);
    EXPECT_EQ(after.places[after.placements[1].effective_cluster].source,
              FrameSource::kWhereabouts);
    EXPECT_LT(largest_move(before, after), 0.5);
}

TEST_F(PlaceComponents, PositionsNeverBendWhatVisionJoins) {
    MergeProblem problem = cut.problem();
    problem.evidence = evidence(0, 42);
    const MergeResult plain = merged(cut.problem());
    const MergeResult result = merged(problem, options);
    EXPECT_EQ(result.effective_clusters, 1U);
    const auto relative = [](const MergeResult& merge) {
        return inverse(merge.placements[0].world_from_cluster) *
               merge.placements[1].world_from_cluster;
    };
    EXPECT_LT(test::difference(relative(result), relative(plain)), 1e-9);
}

TEST_F(PlaceComponents, RefusesBadEvidenceAndOptions) {
    MergeProblem problem = apart();
    problem.evidence = evidence(0, 42);
    std::swap(problem.evidence[0], problem.evidence[1]);
    EXPECT_FALSE(run_merge(problem, options).ok());
    options.georeference.min_positions = 2;
    EXPECT_FALSE(run_merge(apart(), options).ok());
    options = {};
    options.gravity.roll_sigma_deg = 0.0;
    EXPECT_FALSE(run_merge(apart(), options).ok());
}

}  // namespace
}  // namespace psfm
