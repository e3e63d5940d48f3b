// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/report/describe_events.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/scheduler/session/made_up_clusters.h"

namespace psfm {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<Image> named_images(std::uint32_t count) {
    std::vector<Image> images(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        images[i].id = ImageId{i};
        images[i].name = "photo" + std::to_string(i) + ".jpg";
    }
    return images;
}

/// Cluster 3 with five images, of which the model has four after a reset.
struct ResetOfFive {
    std::vector<Image> images = named_images(5);
    ClusterProblem problem;
    ClusterSolution solution;

    explicit ResetOfFive(std::vector<ImageId> reset_images) {
        problem.cluster = ClusterId{3};
        Reconstruction model;
        for (std::uint32_t i = 0; i < 5; ++i) {
            problem.images.push_back({ImageId{i}, CameraId{}, 0, nullptr});
            if (i < 4) model.images.push_back({ImageId{i}, CameraId{}, {}});
        }
        solution.model = std::make_shared<const Reconstruction>(std::move(model));
        solution.statistics.reset = Reset{Reset::Reason::kContradiction,
                                          {{ImageId{1}, ImageId{2}}, 59.7, 9, 2},
                                          4,
                                          std::move(reset_images)};
    }
    SessionEvent event() const { return describe_reset(problem, solution, images); }
};

TEST(DescribeReset, TellsOfAWholeCluster) {
    const SessionEvent event = ResetOfFive({}).event();
    EXPECT_EQ(event.text,
              "cluster 3 was reset: its model turned photo1.jpg against photo2.jpg by 60 degrees "
              "otherwise than the averaged rotations, and so for 2 of 9 edges; the new model has "
              "4 of 5 images");
    const auto detail = nlohmann::json::parse(event.detail_json);
    EXPECT_EQ(detail.at("scope"), "cluster");
    EXPECT_TRUE(detail.at("reset_images").empty());
}

TEST(DescribeReset, TellsOfAModelThatCouldNotGrow) {
    ResetOfFive reset({});
    reset.solution.statistics.reset = Reset{Reset::Reason::kStuck, {}, 2};
    const SessionEvent event = reset.event();
    EXPECT_EQ(event.text,
              "cluster 3 was reset: only 2 of its images could be placed in its model; the new "
              "model has 4 of 5 images");
    EXPECT_TRUE(event.images.empty());
    EXPECT_EQ(nlohmann::json::parse(event.detail_json).at("reason"), "stuck");
}

TEST(DescribeReset, NamesTheImagesThatWerePlacedAnew) {
    const SessionEvent event = ResetOfFive({ImageId{1}}).event();
    EXPECT_THAT(event.text, StartsWith("photo1.jpg of cluster 3 placed anew: "));
    const auto detail = nlohmann::json::parse(event.detail_json);
    EXPECT_EQ(detail.at("scope"), "images");
    EXPECT_EQ(detail.at("reset_images"), nlohmann::json({"photo1.jpg"}));
}

TEST(DescribeReset, NamesFiveImages) {
    const SessionEvent event =
        ResetOfFive({ImageId{0}, ImageId{1}, ImageId{2}, ImageId{3}, ImageId{4}}).event();
    EXPECT_THAT(event.text,
                StartsWith("photo0.jpg, photo1.jpg, photo2.jpg, photo3.jpg, photo4.jpg of "));
    EXPECT_THAT(event.detail_json, HasSubstr("photo4.jpg"));
}

TEST(DescribeEvents, APlaceMayHaveOneImage) {
    ResetOfFive found({});
    found.solution.places = {{ImageId{0}, ImageId{1}}, {ImageId{4}}};
    EXPECT_THAT(describe_places(found.problem, found.solution, found.images).text,
                HasSubstr("that of photo0.jpg (2 images), photo4.jpg (1 image); "));
}

TEST(DescribeEvents, SettlingNamesTheLargestModel) {
    const std::vector<SettlingModel> two{{ClusterId{4}, 7}, {ClusterId{9}, 120}};
    const SessionEvent event = describe_settling(two);
    EXPECT_EQ(event.kind, SessionEvent::Kind::kSettle);
    EXPECT_EQ(event.text, "settling 2 models, the largest of 120 images");
    EXPECT_EQ(event.clusters, (std::vector{4U, 9U}));
    EXPECT_EQ(nlohmann::json::parse(event.detail_json),
              (nlohmann::json{{"models", 2}, {"largest", 120}}));
    EXPECT_EQ(describe_settling(std::span(two).first(1)).text, "settling the model of 7 images");
}

TEST(DescribeEvents, FailuresAreOneSentence) {
    ClusterTable table(test::kMuMin);
    for (const std::uint32_t id : {4U, 7U}) {
        const std::uint32_t first = 3 * id;
        table.apply(test::members(id, {first, first + 1, first + 2}));
    }
    const auto taken = table.take_dirty();
    EXPECT_EQ(describe_failures(table), std::nullopt);
    const Error error{ErrorCode::kInternal, "no memory"};
    table.fail(test::solve_of(*taken[0], {}).problem, error);
    EXPECT_EQ(describe_failures(table),
              "cluster 4 (3 images) could not be solved: no memory; what was there before is kept, "
              "and `psfm resume` tries again");
    table.fail(test::solve_of(*taken[1], {}).problem, error);
    EXPECT_THAT(*describe_failures(table), StartsWith("cluster 4 (3 images) and 1 other could "));
}

}  // namespace
}  // namespace psfm
