// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/missing_regions.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "stages/reconstruction/checks/judged_model.h"
#include "tests/stages/reconstruction/two_streets.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

std::vector<ComparedPair> compared(const SyntheticScene& scene, const DoubtOptions& options = {}) {
    return compare_by_region(synthetic::true_reconstruction(scene, synthetic::random_gauge(3)),
                             options);
}

std::ptrdiff_t contradicting(const std::vector<ComparedPair>& pairs,
                             const DoubtOptions& options = {}) {
    return std::ranges::count_if(
        pairs, [&](const ComparedPair& pair) { return contradicts(pair, options); });
}

TEST(MissingRegions, ARightModelMissesNone) {
    for (const SyntheticScene& scene : {synthetic::make_scene(synthetic::line_along_wall(40), 1),
                                        synthetic::make_scene(synthetic::ring_in_room(40), 1)}) {
        const auto pairs = compared(scene);
        ASSERT_GT(pairs.size(), 30U);
        EXPECT_EQ(contradicting(pairs), 0);
    }
}

TEST(MissingRegions, TwoStreetsInOneContradictEachOther) {
    for (const double copied : {0.2, 0.4, 0.6}) {
        const auto pairs = compared(two_streets(40, copied, 2));
        EXPECT_GT(contradicting(pairs), 10) << copied;
        for (const ComparedPair& pair : pairs) {
            if ((pair.second - pair.first) % 2 != 0) continue;
            EXPECT_EQ(pair.missing, 0U) << "one street " << pair.first << ' ' << pair.second;
        }
    }
}

TEST(MissingRegions, WhatStandsInBetweenHidesNothingThatIsMissed) {
    // Seen from the second street, all of its own stands nearer than what the first one has.
    SyntheticScene scene = two_streets(40, 0.4, 2);
    Reconstruction model = synthetic::true_reconstruction(scene, {});
    std::vector<ScenePoint> points = model.points.to_vector();
    for (ScenePoint& point : points) {
        const bool of_second = index_of(point.track.front().image) % 2 == 1;
        const bool in_both = std::ranges::any_of(point.track, [](const Observation& observation) {
            return index_of(observation.image) % 2 == 0;
        });
        if (of_second && !in_both) {
            const Eigen::Vector3d centre =
                model.find(point.track.front().image)->cam_from_cluster.target_origin_in_source();
            point.position = centre + 0.5 * (point.position - centre);
        }
    }
    model.points = std::move(points);
    DoubtOptions blind;
    blind.min_depth = 0.0;
    const auto hidden = contradicting(compare_by_region(model, {}));
    EXPECT_LT(hidden, contradicting(compare_by_region(model, blind), blind));
}

TEST(MissingRegions, OptionsAreChecked) {
    DoubtOptions options;
    EXPECT_TRUE(validate(options).ok());
    options.grid = 0;
    EXPECT_FALSE(validate(options).ok());
    options = {};
    options.as_well_explained = 1.1;
    EXPECT_FALSE(validate(options).ok());
    options = {};
    options.min_rivalry = -0.1;
    EXPECT_FALSE(validate(options).ok());
}

TEST(ModelScore, LessMissingOutweighsMoreExplained) {
    const ModelScore folded{
        .images = 20, .observations = 1000, .regions = 500, .missing = 60, .contradicting = 8};
    ModelScore right{
        .images = 20, .observations = 950, .regions = 400, .missing = 2, .contradicting = 0};
    EXPECT_TRUE(is_better(right, folded, {}));
    EXPECT_FALSE(is_better(folded, right, {}));
    right.observations = 500;
    EXPECT_FALSE(is_better(right, folded, {})) << "it has come apart";
    right.observations = 950;
    right.images = 19;
    EXPECT_FALSE(is_better(right, folded, {})) << "an image is lost";
    right.images = 20;
    right.loose = 6;
    EXPECT_FALSE(is_better(right, folded, {})) << "a part of it swings";
    ModelScore swings = folded;
    swings.loose = 6;
    EXPECT_TRUE(is_better(right, swings, {})) << "so does the other's";
}

TEST(ModelScore, WhereTheSameIsMissingTheOneThatExplainsMoreIsBetter) {
    const ModelScore one{
        .images = 20, .observations = 1000, .regions = 500, .missing = 6, .contradicting = 0};
    ModelScore other = one;
    EXPECT_FALSE(is_better(other, one, {}));
    other.observations = 1100;
    other.missing = 14;
    EXPECT_TRUE(is_better(other, one, {}));
    EXPECT_FALSE(is_better(one, other, {}));
}

TEST(ModelScore, OneWithoutADoubtIsBetterWhereItExplainsAsMuch) {
    const ModelScore doubted{
        .images = 20, .observations = 1000, .regions = 500, .missing = 6, .contradicting = 1};
    ModelScore other{.images = 20, .observations = 985, .regions = 500, .missing = 6};
    EXPECT_TRUE(is_better(other, doubted, {}));
    other.observations = 975;
    EXPECT_FALSE(is_better(other, doubted, {})) << "it explains less";
    other.observations = 985;
    other.denied = 1;
    EXPECT_FALSE(is_better(other, doubted, {})) << "it is doubted, too";
}

TEST(ModelScore, AModelOfWhichMoreIsMissingTakesNoOthersPlace) {
    const SyntheticScene folded = two_streets(40, 0.4, 2);
    const SyntheticScene right = synthetic::make_scene(synthetic::line_along_wall(40), 1);
    const auto model_of = [](const SyntheticScene& scene) {
        return synthetic::true_reconstruction(scene, synthetic::random_gauge(3));
    };
    EXPECT_TRUE(brings_doubt(model_of(folded), model_of(right), {}));
    EXPECT_FALSE(brings_doubt(model_of(right), model_of(folded), {}));
    EXPECT_FALSE(brings_doubt(model_of(right), model_of(right), {}));
    SolveOptions options;
    options.policy.doubt_up_to = 39;
    EXPECT_FALSE(brings_doubt(model_of(folded), model_of(right), options)) << "not asked";
}

}  // namespace
}  // namespace psfm
