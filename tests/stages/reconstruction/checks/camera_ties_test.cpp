// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/camera_ties.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

namespace psfm {
namespace {

CameraId camera(std::uint32_t id) {
    return static_cast<CameraId>(id);
}

/// Images 0 … count - 1 with a camera each, those from `turned_from` on upright.
ClusterProblem problem_of_size(std::uint32_t count, std::uint32_t turned_from) {
    ClusterProblem problem;
    const auto none = std::make_shared<const Keypoints>();
    for (std::uint32_t i = 0; i < count; ++i) {
        problem.images.push_back({static_cast<ImageId>(i), camera(i), i, none});
        const bool turned = i >= turned_from;
        problem.cameras[camera(i)] =
            make_camera(turned ? 300 : 400, turned ? 400 : 300, 480, FocalSource::kUnknown);
        problem.alike[camera(i)] = 0;
    }
    return problem;
}

/// A model of some images; image and camera by turns.
std::shared_ptr<const Reconstruction> model_of(
    const std::vector<std::pair<std::uint32_t, std::uint32_t>>& placed,
    const ClusterProblem& problem, double focal = 500) {
    auto model = std::make_shared<Reconstruction>();
    for (const auto& [image, standing] : placed) {
        model->images.push_back({static_cast<ImageId>(image), camera(standing), {}});
        Camera known = problem.cameras.at(camera(standing));
        known.params[0] = focal + standing;
        known.focal_source = FocalSource::kEstimated;
        model->cameras[camera(standing)] = known;
    }
    return model;
}

std::vector<std::uint32_t> standing(const CameraTies& ties) {
    std::vector<std::uint32_t> result;
    for (const auto& [own, other] : ties.standing) result.push_back(index_of(other));
    return result;
}

using Ids = std::vector<std::uint32_t>;

TEST(CameraTies, WithoutAModelAllOfAKindAreTied) {
    ClusterProblem problem = problem_of_size(5, 5);
    problem.alike[camera(3)] = problem.alike[camera(4)] = 1;
    problem.alike.erase(camera(2));
    EXPECT_EQ(standing(recycled_ties(problem)), (Ids{0, 0, 2, 3, 3}));
    EXPECT_EQ(recycled_ties(problem), all_tied(problem));
    EXPECT_EQ(standing(untied(problem)), (Ids{0, 1, 2, 3, 4}));
}

TEST(CameraTies, NewImagesJoinTheMainTieOfTheModel) {
    ClusterProblem problem = problem_of_size(8, 8);
    // 1, 2, 4 are tied, as are 3 and 5; 0 stands alone; 6 and 7 are new.
    problem.recycled = {model_of({{0, 0}, {1, 1}, {2, 1}, {3, 3}, {4, 1}, {5, 3}}, problem)};
    EXPECT_EQ(standing(recycled_ties(problem)), (Ids{0, 1, 1, 3, 1, 3, 1, 1}));
}

TEST(CameraTies, WhereAllStandAloneSoDoNewOnes) {
    ClusterProblem problem = problem_of_size(4, 4);
    problem.recycled = {model_of({{0, 0}, {1, 1}, {2, 2}}, problem)};
    EXPECT_EQ(standing(recycled_ties(problem)), (Ids{0, 1, 2, 3}));
}

TEST(CameraTies, TheMainTiesOfSeveralModelsBecomeOne) {
    ClusterProblem problem = problem_of_size(7, 7);
    // The first image of the tie has left: camera 0 is that of another one here.
    problem.recycled = {model_of({{1, 0}, {2, 0}, {3, 0}}, problem),
                        model_of({{4, 4}, {5, 4}, {6, 6}}, problem)};
    EXPECT_EQ(standing(recycled_ties(problem)), (Ids{0, 0, 0, 0, 0, 0, 6}));
}

TEST(CameraTies, TurnedPhotographsShareALensAndNoPrincipalPoint) {
    ClusterProblem problem = problem_of_size(6, 4);
    const CameraTies ties = recycled_ties(problem);
    EXPECT_EQ(standing(ties), (Ids{0, 0, 0, 0, 4, 4}));
    ASSERT_EQ(ties.twins.size(), 1U);
    EXPECT_EQ(ties.twins.at(camera(4)), camera(0));
    EXPECT_EQ(ties_of(labels_of(ties), problem), ties);

    problem.recycled = {model_of({{0, 0}, {1, 0}, {4, 4}}, problem)};  // of two lenses
    // 4 stays by itself, and what is new, 5 among it, goes with 0 and 1.
    EXPECT_EQ(standing(recycled_ties(problem)), (Ids{0, 0, 0, 0, 4, 5}));
    EXPECT_EQ(recycled_ties(problem).twins.at(camera(5)), camera(0));
    EXPECT_FALSE(recycled_ties(problem).twins.contains(camera(4)));
    const auto shared = with_ties(problem.recycled.front(), problem, ties);
    EXPECT_EQ(shared->cameras.at(camera(0)).fx(), shared->cameras.at(camera(4)).fx());
    EXPECT_EQ(shared->cameras.at(camera(4)).principal_point(), Eigen::Vector2d(150, 200));
    problem.recycled = {shared};
    EXPECT_EQ(recycled_ties(problem), ties);
}

TEST(CameraTies, AModelIsTiedAndUntied) {
    const ClusterProblem problem = problem_of_size(4, 4);
    const auto apart = model_of({{0, 0}, {1, 1}, {2, 2}}, problem);
    const auto together = with_ties(apart, problem, all_tied(problem));
    ASSERT_EQ(together->cameras.size(), 1U);
    EXPECT_EQ(together->cameras.at(camera(0)).fx(), 501.0);  // the middle one
    EXPECT_EQ(with_ties(together, problem, all_tied(problem)), together);
    const auto again = with_ties(together, problem, untied(problem));
    ASSERT_EQ(again->cameras.size(), 3U);
    EXPECT_EQ(again->images[2].camera, camera(2));
    EXPECT_EQ(again->cameras.at(camera(2)).fx(), 501.0);
}

TEST(CameraTies, AProblemIsTiedWithAllItHas) {
    ClusterProblem problem = problem_of_size(5, 3);
    problem.recycled = {model_of({{0, 0}, {1, 1}, {3, 3}}, problem)};
    const ClusterProblem result = tied(problem, all_tied(problem));
    EXPECT_EQ(result.cameras.size(), 2U);
    EXPECT_EQ(result.images[2].camera, camera(0));
    EXPECT_EQ(result.images[4].camera, camera(3));
    EXPECT_EQ(lens_of(result, camera(3)), camera(0));
    EXPECT_EQ(result.recycled.front()->cameras.size(), 2U);
    EXPECT_EQ(result.recycled.front()->images[1].camera, camera(0));
}

}  // namespace
}  // namespace psfm
