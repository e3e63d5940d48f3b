// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/close_loops.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <vector>

#include "stages/reconstruction/build/refine_model.h"
#include "stages/reconstruction/checks/open_edges.h"
#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/scene.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

constexpr std::uint32_t kImages = 120;

/// Where what image `i` sees of a ring has drifted to: a turn and a shift that grow along the ring,
/// so that the last image's surroundings do not meet the first one's.
Sim3 drift(std::uint32_t image, double turn_rad, double shift) {
    const double part = static_cast<double>(image) / kImages;
    return {1.0, Eigen::Quaterniond(Eigen::AngleAxisd(part * turn_rad, Eigen::Vector3d::UnitZ())),
            part * shift * Eigen::Vector3d::UnitX()};
}

/// The true model as it becomes by drift: a point that the first images see as well as the last
/// ones is there twice.
Reconstruction drifted(const SyntheticScene& scene, const std::vector<ImageId>& images,
                       double turn_rad, double shift) {
    Reconstruction model = synthetic::true_reconstruction(scene, Sim3{}, images);
    for (RegisteredImage& image : model.images) {
        image.cam_from_cluster =
            transform_pose(image.cam_from_cluster, drift(index_of(image.image), turn_rad, shift));
    }
    std::vector<ScenePoint> points;
    for (const ScenePoint& point : model.points) {
        std::map<bool, ScenePoint> halves;
        for (const Observation& seen : point.track)
            halves[index_of(seen.image) < kImages / 2].track.push_back(seen);
        const std::uint32_t span =
            index_of(point.track.back().image) - index_of(point.track.front().image);
        if (span <= kImages / 2) halves = {{true, point}};
        for (auto& [is_first, half] : halves) {
            if (half.track.size() < 2) continue;
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (const Observation& seen : half.track)
                sum += drift(index_of(seen.image), turn_rad, shift) * point.position;
            half.position = sum / static_cast<double>(half.track.size());
            points.push_back(half);
        }
    }
    model.points = std::move(points);
    return model;
}

class CloseLoops : public ::testing::Test {
  protected:
    /// A ring of photographs around a room, and its model, that has drifted.
    void make(double turn_rad, double shift) {
        scene_ = synthetic::make_scene(synthetic::ring_in_room(kImages), 3);
        problem_ = problem_of(scene_, synthetic::make_verified_pairs(scene_));
        problem_.fix_intrinsics = true;
        std::vector<ImageId> images;
        for (const ClusterImage& image : problem_.images) images.push_back(image.id);
        start_ = std::make_shared<const Reconstruction>(drifted(scene_, images, turn_rad, shift));
        load();
    }

    void load() {
        graph_ = std::make_unique<LocalGraph>();
        graph_->pairs = pairs_of(problem_);
        matches_ = std::make_unique<CorrespondenceGraph>(correspondences_of(problem_, *graph_));
        model_ = std::make_unique<WorkingModel>(problem_, *matches_);
        model_->load(*start_);
        options_.policy.affordable_up_to = 19;
    }

    std::uint32_t close() {
        const auto closing = close_loops(*model_, {problem_, *graph_, options_});
        EXPECT_TRUE(closing.ok());
        if (!closing.ok()) return 0;
        EXPECT_EQ(closing->shows_one_place, closing->adjustments > 0);
        return closing->adjustments;
    }

    void settle() {
        EXPECT_TRUE(
            refine_model(*model_, options_.settling, {.options = options_, .fix_intrinsics = true})
                .ok());
    }

    double error() const {
        const auto error = synthetic::compare_with_truth(model_->save(), scene_);
        EXPECT_TRUE(error.ok());
        return error.ok() ? error->mean_position : 1e9;
    }

    std::size_t open_edges() const {
        return find_open_edges(*model_, *graph_, options_.loops).size();
    }

    SyntheticScene scene_;
    ClusterProblem problem_;
    std::shared_ptr<const Reconstruction> start_;
    std::unique_ptr<LocalGraph> graph_;
    std::unique_ptr<CorrespondenceGraph> matches_;
    std::unique_ptr<WorkingModel> model_;
    SolveOptions options_;
};

TEST_F(CloseLoops, ARingThatHasDriftedApartIsClosed) {
    make(0.3, 1.0);
    const double before = error();
    ASSERT_GE(open_edges(), options_.loops.min_open_edges);
    EXPECT_GT(close(), 0U);
    EXPECT_EQ(open_edges(), 0U);
    EXPECT_LT(error(), 0.5 * before);
    EXPECT_EQ(model_->registered_count(), kImages);
    settle();
    EXPECT_LT(error(), 0.01 * before) << "the rest is for adjustment";
}

TEST_F(CloseLoops, ByMoreDriftThanOnePlaceCouldTake) {
    make(0.9, 2.0);
    const double before = error();
    EXPECT_GT(close(), 0U);
    EXPECT_EQ(open_edges(), 0U);
    EXPECT_LT(error(), 0.5 * before);
    settle();
    EXPECT_LT(error(), 0.01 * before);
}

TEST_F(CloseLoops, AModelWithoutOpenEdgesStaysAsItIs) {
    make(0.0, 0.0);
    EXPECT_EQ(open_edges(), 0U);
    EXPECT_EQ(close(), 0U);
    EXPECT_LT(error(), 1e-6);
}

TEST_F(CloseLoops, AFewOpenEdgesAreLeftToThemselves) {
    make(0.3, 1.0);
    options_.loops.min_open_edges = static_cast<std::uint32_t>(open_edges()) + 1;
    const Reconstruction before = model_->save();
    EXPECT_EQ(close(), 0U);
    const Reconstruction after = model_->save();
    ASSERT_EQ(after.images.size(), before.images.size());
    for (std::size_t i = 0; i < before.images.size(); ++i) {
        EXPECT_EQ(after.images[i].cam_from_cluster.translation,
                  before.images[i].cam_from_cluster.translation);
    }
}

TEST_F(CloseLoops, ThePaperNeverDoes) {
    make(0.3, 1.0);
    options_.loops.min_open_edges = 0;
    EXPECT_EQ(close(), 0U);
}

TEST_F(CloseLoops, BelongsToSettling) {
    make(0.1, 2.0);  // turned by less than what counts as a contradiction
    ASSERT_GE(open_edges(), options_.loops.min_open_edges);
    problem_.recycled = {start_};
    problem_.recycled_state.images_at_start = kImages;
    problem_.settle = true;
    const auto solution = solve_cluster(problem_, options_);
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->statistics.closed_loops, 1U);
    EXPECT_EQ(solution->model->images.size(), kImages);

    options_.policy.affordable_up_to = kImages;
    const auto adjusted = solve_cluster(problem_, options_);
    ASSERT_TRUE(adjusted.ok());
    EXPECT_EQ(adjusted->statistics.closed_loops, 0U) << "small models are adjusted instead";

    options_.policy.affordable_up_to = 19;
    options_.loops.min_open_edges = 0;
    const auto without = solve_cluster(problem_, options_);
    ASSERT_TRUE(without.ok());
    EXPECT_EQ(without->statistics.closed_loops, 0U);
}

TEST_F(CloseLoops, WhatCannotBeAdjustedInTimeIsLeftAsItWas) {
    make(0.3, 1.0);
    const double before = error();
    const std::atomic<bool> cancel{true};
    const auto closed = close_loops(*model_, {problem_, *graph_, options_, &cancel});
    ASSERT_FALSE(closed.ok());
    EXPECT_EQ(closed.error().code, ErrorCode::kCancelled);
    EXPECT_EQ(error(), before);
}

/// Matches of features that look alike on opposite walls, in a model that is right.
class WrongLoops : public CloseLoops {
  protected:
    void SetUp() override {
        make(0.0, 0.0);
        std::vector<VerifiedPairPtr> pairs = pairs_of(problem_);
        for (std::uint32_t i = 0; i < 20; ++i) {
            const ImagePair ends{static_cast<ImageId>(i), static_cast<ImageId>(i + kImages / 2)};
            if (std::ranges::find(pairs, ends, [](const auto& pair) { return pair->pair; }) !=
                pairs.end())
                continue;
            VerifiedPair wrong{ends, {}};
            wrong.geometry.inliers = look_alikes(ends);
            pairs.push_back(std::make_shared<const VerifiedPair>(std::move(wrong)));
        }
        std::ranges::sort(pairs, {}, [](const VerifiedPairPtr& pair) { return pair->pair; });
        ASSERT_GT(pairs.size(), pairs_of(problem_).size() + 5);
        problem_.view_graph = ViewGraph(pairs);
        load();
        options_.loops.min_open_edges = 5;
        ASSERT_GE(open_edges(), options_.loops.min_open_edges);
    }

  private:
    /// As if the point that the first image sees stood half way round the ring as well: the
    /// features of the second image nearest to where it would be seen.
    std::vector<FeatureMatch> look_alikes(const ImagePair& ends) const {
        const Keypoints& first = *problem_.images[index_of(ends.first)].keypoints;
        const Keypoints& second = *problem_.images[index_of(ends.second)].keypoints;
        std::vector<FeatureMatch> matches;
        std::vector<bool> used(second.size(), false);
        for (std::uint32_t f = 0; f < first.size(); ++f) {
            std::uint32_t nearest = 0;
            double least = 1e9;
            for (std::uint32_t g = 0; g < second.size(); ++g) {
                const double distance = (first[f].position() - second[g].position()).norm();
                if (distance < least && !used[g]) {
                    least = distance;
                    nearest = g;
                }
            }
            if (least > 25.0) continue;
            used[nearest] = true;
            matches.push_back({f, nearest});
        }
        return matches;
    }
};

TEST_F(WrongLoops, DoNotTearAModel) {
    EXPECT_EQ(close(), 0U);
    EXPECT_LT(error(), 1e-6);
}

/// Nothing would close here, so that only the search itself can say it.
TEST_F(WrongLoops, ASearchThatIsStoppedSaysSo) {
    const std::atomic<bool> cancel{true};
    const auto closed = close_loops(*model_, {problem_, *graph_, options_, &cancel});
    ASSERT_FALSE(closed.ok());
    EXPECT_EQ(closed.error().code, ErrorCode::kCancelled);
}

TEST_F(WrongLoops, AreToldByWhatTheyCostWhereNothingTears) {
    options_.loops.max_residual = 1e9;
    EXPECT_EQ(close(), 0U);
    EXPECT_LT(error(), 1e-6);
}

}  // namespace
}  // namespace psfm
