// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/grow_model.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <set>
#include <vector>

#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/stages/reconstruction/scene_model.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

constexpr ImageId kLastButOne{10};
constexpr ImageId kLast{11};

/// The feature of an image in a match of a pair that it is part of.
std::uint32_t feature_in(const ImagePair& pair, ImageId image, const FeatureMatch& match) {
    return pair.first == image ? match.first : match.second;
}

bool has(const ImagePair& pair, ImageId image) {
    return pair.first == image || pair.second == image;
}

/// A ring whose last image shares its features with the last but one alone, and that one few with
/// all others: when it is placed, `seen_by_last` points are seen by the last one.
std::vector<VerifiedPairPtr> thin_chain(const SyntheticScene& scene, std::size_t seen_by_last) {
    constexpr std::size_t kShared = 26;
    std::set<std::uint32_t> shared;  // features of the last but one that others may have
    std::set<std::uint32_t> seen;    // those of them that the last one has as well
    std::vector<VerifiedPairPtr> pairs;
    for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
        if (has(pair->pair, kLastButOne) && has(pair->pair, kLast)) {
            for (const FeatureMatch& match : pair->geometry.inliers) {
                if (seen.size() < seen_by_last)
                    seen.insert(feature_in(pair->pair, kLastButOne, match));
            }
        }
    }
    shared = seen;
    for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
        if (!has(pair->pair, kLastButOne) || has(pair->pair, kLast)) continue;
        for (const FeatureMatch& match : pair->geometry.inliers) {
            if (shared.size() < kShared) shared.insert(feature_in(pair->pair, kLastButOne, match));
        }
    }
    for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
        const bool of_last = has(pair->pair, kLast);
        if (of_last && !has(pair->pair, kLastButOne)) continue;
        VerifiedPair thinned = *pair;
        if (has(pair->pair, kLastButOne)) {
            std::erase_if(thinned.geometry.inliers, [&](const FeatureMatch& match) {
                const std::uint32_t feature = feature_in(pair->pair, kLastButOne, match);
                return of_last ? shared.contains(feature) && !seen.contains(feature)
                               : !shared.contains(feature);
            });
        }
        pairs.push_back(std::make_shared<const VerifiedPair>(std::move(thinned)));
    }
    return pairs;
}

TEST(GrowModel, AnImageThatSeesFewPointsIsPlacedWhereStructureConfirmsIt) {
    const SyntheticScene scene = synthetic::add_pixel_noise(
        synthetic::make_scene(synthetic::ring_around_sphere(12), 1), 0.3, 2);
    ClusterProblem problem = problem_of(scene, thin_chain(scene, 14));
    problem.fix_intrinsics = true;
    SolveOptions options;
    const auto solution = solve_cluster(problem, options);
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->model->images.size(), 12U);
    const auto error = synthetic::compare_with_truth(*solution->model, scene);
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->max_position, 0.1);  // of a ring of 8 m radius

    options.few_points.min_points = 0;
    const auto without = solve_cluster(problem, options);
    ASSERT_TRUE(without.ok());
    EXPECT_EQ(without->model->images.size(), 11U);
}

/// Gives `wrong` of the features that the last two images share and others have as well to each
/// other.
void mistake(std::vector<VerifiedPairPtr>& pairs, std::size_t wrong) {
    std::set<std::uint32_t> shared;
    for (const VerifiedPairPtr& pair : pairs) {
        if (!has(pair->pair, kLastButOne) || has(pair->pair, kLast)) continue;
        for (const FeatureMatch& match : pair->geometry.inliers)
            shared.insert(feature_in(pair->pair, kLastButOne, match));
    }
    for (VerifiedPairPtr& pair : pairs) {
        if (!has(pair->pair, kLast)) continue;
        VerifiedPair changed = *pair;
        std::vector<FeatureMatch*> mistaken;
        for (FeatureMatch& match : changed.geometry.inliers) {
            if (shared.contains(match.first) && mistaken.size() < wrong) mistaken.push_back(&match);
        }
        for (std::size_t i = 0; i + 1 < mistaken.size(); ++i)
            std::swap(mistaken[i]->second, mistaken[i + 1]->second);
        pair = std::make_shared<const VerifiedPair>(std::move(changed));
    }
}

TEST(GrowModel, WhoSeesEnoughPointsOfWhichTooFewAgreeIsAskedForFewer) {
    const SyntheticScene scene = synthetic::add_pixel_noise(
        synthetic::make_scene(synthetic::ring_around_sphere(12), 1), 0.3, 2);
    std::vector<VerifiedPairPtr> pairs = thin_chain(scene, 26);
    mistake(pairs, 9);
    ClusterProblem problem = problem_of(scene, pairs);
    problem.fix_intrinsics = true;
    const auto solution = solve_cluster(problem, {});
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->model->images.size(), 12U) << "17 of 26 agree";
    const auto error = synthetic::compare_with_truth(*solution->model, scene);
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->max_position, 0.1);  // of a ring of 8 m radius
}

TEST(GrowModel, FewerPointsThanThatAreNoPose) {
    const SyntheticScene scene = synthetic::add_pixel_noise(
        synthetic::make_scene(synthetic::ring_around_sphere(12), 1), 0.3, 2);
    ClusterProblem problem = problem_of(scene, thin_chain(scene, 6));
    problem.fix_intrinsics = true;
    const auto solution = solve_cluster(problem, {});
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->model->images.size(), 11U);
    ASSERT_EQ(solution->waiting.size(), 1U);
    EXPECT_EQ(solution->waiting.front().first, kLast);
}

/// The ring's last image as one of another camera, of which nothing is known, and `matches` with
/// the last but one are all that it has.
ClusterProblem with_own_camera_of_last(SyntheticScene& scene, std::size_t matches) {
    constexpr CameraId kOwn{77};
    const Camera known = scene.cameras.begin()->second;
    scene.images[index_of(kLast)].camera = kOwn;
    scene.cameras[kOwn] = make_camera(known.width, known.height, known.fx(), FocalSource::kUnknown);
    std::vector<VerifiedPairPtr> pairs = synthetic::make_verified_pairs(scene);
    std::erase_if(pairs, [](const VerifiedPairPtr& pair) {
        return has(pair->pair, kLast) && !has(pair->pair, kLastButOne);
    });
    for (VerifiedPairPtr& pair : pairs) {
        if (!has(pair->pair, kLast)) continue;
        VerifiedPair thinned = *pair;
        thinned.geometry.inliers.resize(matches);
        pair = std::make_shared<const VerifiedPair>(std::move(thinned));
    }
    return problem_of(scene, std::move(pairs));
}

TEST(GrowModel, AnImageThatDoesNotStayTellsNothingOfItsLens) {
    SyntheticScene scene = synthetic::add_pixel_noise(
        synthetic::make_scene(synthetic::ring_around_sphere(12), 1), 0.3, 2);
    const ClusterProblem problem = with_own_camera_of_last(scene, 18);
    const SolveOptions options;
    const auto graph = make_local_graph(problem, options);
    ASSERT_TRUE(graph.ok());
    const CorrespondenceGraph matches = correspondences_of(problem, *graph);
    SolveDraft draft{WorkingModel(problem, matches), {}, {}};
    std::vector<ImageId> others;
    for (std::uint32_t image = 0; image < 11; ++image) others.push_back(ImageId{image});
    draft.model.load(synthetic::true_reconstruction(scene, Sim3{}, others));
    const Camera before = draft.model.camera(11);
    ASSERT_EQ(before.focal_source, FocalSource::kUnknown);
    ASSERT_GE(draft.model.visible_points(11), options.few_points.min_points);
    ASSERT_LT(draft.model.visible_points(11), options.few_points.min_observations);

    ASSERT_TRUE(grow_model(draft, {problem, *graph, options, nullptr}).ok());
    ASSERT_FALSE(draft.model.registered(11)) << "it has a pose, and too few observations";
    EXPECT_EQ(draft.model.camera(11), before);
}

/// A ring's true model, some images taken out of it.
class GrowAModel : public testing::Test {
  protected:
    void make(std::uint32_t images, const std::vector<std::uint32_t>& missing) {
        truth_ = std::make_unique<SceneModel>(synthetic::add_pixel_noise(
            synthetic::make_scene(synthetic::ring_around_sphere(images), 1), 0.3, 2));
        truth_->problem.fix_intrinsics = true;
        for (const std::uint32_t image : missing) model().remove_image(image);
        state_.images_at_full_adjustment = model().registered_count();
    }

    WorkingModel& model() const { return *truth_->model; }

    Result<void> grow(std::uint32_t at_most, const std::atomic<bool>* cancel = nullptr) {
        SolveDraft draft{std::move(model()), state_, statistics_};
        const LocalGraph graph;
        const SolveOptions options;
        const auto done = grow_model(draft, {truth_->problem, graph, options, cancel}, at_most);
        model() = std::move(draft.model);
        state_ = draft.state;
        statistics_ = draft.statistics;
        return done;
    }

    double max_error() const {
        const auto error = synthetic::compare_with_truth(model().save(), truth_->scene);
        EXPECT_TRUE(error.ok());
        return error.ok() ? error->max_position : 1e9;
    }

    static constexpr std::uint32_t kAll = std::numeric_limits<std::uint32_t>::max();
    std::unique_ptr<SceneModel> truth_;
    SolveState state_;
    SolveStatistics statistics_;
};

TEST_F(GrowAModel, AddsWhatIsMissing) {
    make(12, {3, 4, 9});
    ASSERT_TRUE(grow(kAll).ok());
    EXPECT_EQ(model().registered_count(), 12U);
    EXPECT_EQ(statistics_.registered, 3U);
    EXPECT_LT(max_error(), 0.02);  // of a ring of 8 m radius
    EXPECT_GE(statistics_.local_adjustments, 3U) << "around each of them";
    EXPECT_GE(statistics_.full_adjustments, 1U) << "by a third";
    EXPECT_GT(state_.images_at_full_adjustment, 9U);
}

TEST_F(GrowAModel, OneImageOfManyChangesItsSurroundingsOnly) {
    make(24, {7});
    ASSERT_TRUE(grow(kAll).ok());
    EXPECT_EQ(model().registered_count(), 24U);
    EXPECT_EQ(statistics_.full_adjustments, 0U);
    EXPECT_GE(statistics_.local_adjustments, 1U);
    EXPECT_EQ(state_.images_at_full_adjustment, 23U);
}

TEST_F(GrowAModel, TheImageThatSeesMostComesFirst) {
    make(12, {3, 4, 5, 6, 7, 10});
    std::uint32_t best = 3;
    for (const std::uint32_t image : {4, 5, 6, 7, 10}) {
        if (model().visible_score(image) > model().visible_score(best)) best = image;
    }
    ASSERT_EQ(best, 10U) << "between two that are there";
    ASSERT_TRUE(grow(1).ok());
    EXPECT_EQ(model().registered_count(), 7U);
    EXPECT_TRUE(model().registered(10));
    EXPECT_EQ(statistics_.registered, 1U);
    ASSERT_TRUE(grow(2).ok());
    EXPECT_EQ(model().registered_count(), 9U);
    EXPECT_EQ(statistics_.registered, 3U) << "counted on";
}

TEST_F(GrowAModel, AnImageWithoutMatchesStaysOut) {
    make(12, {3, 4});
    auto pairs = pairs_of(truth_->problem);
    std::erase_if(pairs, [](const VerifiedPairPtr& pair) { return has(pair->pair, ImageId{4}); });
    std::vector<std::uint32_t> counts;
    std::vector<ImageId> ids;
    for (const ClusterImage& image : truth_->problem.images) {
        counts.push_back(static_cast<std::uint32_t>(image.keypoints->size()));
        ids.push_back(image.id);
    }
    const Reconstruction ten = model().save();
    truth_->matches = std::make_unique<CorrespondenceGraph>(ids, counts, pairs);
    truth_->model = std::make_unique<WorkingModel>(truth_->problem, *truth_->matches);
    model().load(ten);
    ASSERT_TRUE(grow(kAll).ok());
    EXPECT_TRUE(model().registered(3));
    EXPECT_FALSE(model().registered(4));
    EXPECT_EQ(statistics_.registered, 1U);
}

TEST_F(GrowAModel, StopsOnRequest) {
    make(12, {3});
    const std::atomic<bool> cancel{true};
    const auto stopped = grow(kAll, &cancel);
    ASSERT_FALSE(stopped.ok());
    EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
    EXPECT_FALSE(model().registered(3));
}

TEST_F(GrowAModel, AWholeModelStaysAsItIs) {
    make(12, {});
    const std::size_t points = model().alive_points();
    ASSERT_TRUE(grow(kAll).ok());
    EXPECT_EQ(statistics_.registered, 0U);
    EXPECT_EQ(statistics_.local_adjustments + statistics_.full_adjustments, 0U);
    EXPECT_EQ(model().alive_points(), points);
}

}  // namespace
}  // namespace psfm
