// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What a cluster's model leaves out, and makes one of its own.
#include "stages/reconstruction/solve/left_out.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/stages/reconstruction/two_models.h"
#include "tests/synthetic/compare.h"

namespace psfm {
namespace {

using ModelPtr = std::shared_ptr<const Reconstruction>;
using Groups = std::vector<std::vector<ImageId>>;

class LeftOut : public ::testing::Test {
  protected:
    ClusterProblem problem(std::vector<ModelPtr> recycled) const {
        ClusterProblem problem = problem_of(parts_.scene, parts_.pairs);
        problem.fix_intrinsics = true;
        problem.concluding = true;
        problem.recycled = std::move(recycled);
        return problem;
    }
    ModelPtr model_of(const std::vector<ImageId>& images, std::uint64_t gauge) const {
        return std::make_shared<const Reconstruction>(
            synthetic::true_reconstruction(parts_.scene, synthetic::random_gauge(gauge), images));
    }
    /// The images of both models, the one that is in neither with the second.
    static Groups both() {
        return {TwoModels::first(), TwoModels::images(TwoModels::kFirst, TwoModels::kImages)};
    }

    TwoModels parts_;
};

TEST_F(LeftOut, AModelThatFindsNoPlaceInAnotherOneIsOfAPlaceOfItsOwn) {
    const auto solution = solve_cluster(
        problem({model_of(TwoModels::first(), 1), model_of(TwoModels::second(), 2)}), {});
    ASSERT_TRUE(solution.ok()) << solution.error().message;
    EXPECT_EQ(solution->statistics.left_models, 1U);
    EXPECT_EQ(solution->model->images.size(), TwoModels::kFirst);
    EXPECT_EQ(solution->waiting.size(), TwoModels::kImages - TwoModels::kFirst);
    EXPECT_EQ(solution->places, both());
}

TEST_F(LeftOut, SoAreImagesOfWhichANewStartMakesAModel) {
    for (const bool has_model : {true, false}) {
        SCOPED_TRACE(has_model);
        const auto solution =
            solve_cluster(problem(has_model ? std::vector{model_of(TwoModels::first(), 1)}
                                            : std::vector<ModelPtr>{}),
                          {});
        ASSERT_TRUE(solution.ok()) << solution.error().message;
        EXPECT_EQ(solution->model->images.size(), TwoModels::kFirst);
        EXPECT_EQ(solution->places, both());
    }
}

TEST_F(LeftOut, WaitsWhileImagesCome) {
    ClusterProblem streaming =
        problem({model_of(TwoModels::first(), 1), model_of(TwoModels::second(), 2)});
    streaming.concluding = false;
    const auto solution = solve_cluster(streaming, {});
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->model->images.size(), TwoModels::kFirst);
    EXPECT_TRUE(solution->places.empty());
}

TEST_F(LeftOut, WaitsForEverAsInThePaperWhereThatIsAskedFor) {
    SolveOptions options;
    options.places.left_out = 0;
    const auto solution = solve_cluster(
        problem({model_of(TwoModels::first(), 1), model_of(TwoModels::second(), 2)}), options);
    ASSERT_TRUE(solution.ok());
    EXPECT_TRUE(solution->places.empty());
}

TEST_F(LeftOut, FewerThanAModelNeedsWait) {
    ClusterProblem few = problem({model_of(TwoModels::first(), 1)});
    few.images.resize(TwoModels::kFirst + 2);
    const auto solution = solve_cluster(few, {});
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->waiting.size(), 2U);
    EXPECT_TRUE(solution->places.empty());
}

/// Several at once: a cluster is not solved again for each.
TEST_F(LeftOut, EveryModelIsFound) {
    const auto first = model_of(TwoModels::images(0, 5), 1);
    const ClusterProblem whole = problem({first});
    SolveAttempt attempt;
    attempt.model = *first;
    std::vector<Groups::value_type> made{TwoModels::images(9, 15), TwoModels::images(5, 9)};
    std::size_t asked = 0;
    const AttemptSolve solve = [&](const ClusterProblem& rest) -> Result<SolveAttempt> {
        EXPECT_TRUE(rest.recycled.empty());
        SolveAttempt other;
        if (asked < made.size()) other.model = *model_of(made[asked], 3);
        ++asked;
        return other;
    };
    SolveOptions options;
    options.policy.mu_min = 4;
    const auto places = places_of_left_out(whole, attempt, options, solve);
    ASSERT_TRUE(places.ok());
    const Groups expected{TwoModels::images(0, 5), TwoModels::images(9, 16),
                          TwoModels::images(5, 9)};
    EXPECT_EQ(*places, expected);
    EXPECT_EQ(asked, 2U) << "one image is left, which makes no model";
}

TEST_F(LeftOut, EndsWhenTheSolveIsCancelled) {
    const ModelPtr first = model_of(TwoModels::first(), 1);
    SolveAttempt attempt;
    attempt.model = *first;
    const auto places =
        places_of_left_out(problem({first}), attempt, {}, [](const ClusterProblem&) {
            return Result<SolveAttempt>(Error{ErrorCode::kCancelled, "cancelled"});
        });
    ASSERT_FALSE(places.ok());
    EXPECT_EQ(places.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace psfm
