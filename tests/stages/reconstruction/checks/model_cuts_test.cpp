// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/model_cuts.h"

#include <gtest/gtest.h>

#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

constexpr std::uint32_t kImages = 12, kLeft = 6;

/// Photographs along a wall, each joined with the next one; where the left ones meet the right
/// ones, so many regions of ten are missing.
Judged judged(std::uint32_t missing) {
    const auto scene = synthetic::make_scene(synthetic::line_along_wall(kImages), 3);
    Judged model;
    model.attempt.model = synthetic::true_reconstruction(scene, Sim3{});
    model.attempt.places.emplace();
    for (std::uint32_t first = 0; first < kImages; ++first) {
        for (std::uint32_t second = first + 1; second < kImages; ++second) {
            const bool is_across = first < kLeft && second >= kLeft;
            model.compared.push_back({first, second, 10, is_across ? missing : 0});
        }
        if (first > 0) model.edges.push_back({first - 1, first, nullptr, 1.0, 1.0, 1.0, false});
    }
    model.score = score_of(model, {});
    return model;
}

/// And an edge between the outermost images is denied.
Judged contested(std::uint32_t missing) {
    Judged model = judged(missing);
    model.edges.push_back({0, kImages - 1, nullptr, 0.0, 0.5, 1.0, false});
    model.score = score_of(model, {});
    return model;
}

std::optional<Judged> parts_of(const Judged& model) {
    return in_parts(model, cuts_of(model, {}), {});
}

TEST(InParts, AreThoseThatContradictEachOther) {
    const Judged model = contested(4);
    const auto apart = parts_of(model);
    ASSERT_TRUE(apart);
    ASSERT_EQ(apart->attempt.places->size(), 2U);
    EXPECT_EQ(apart->attempt.places->front().back(), ImageId{kLeft - 1});
    EXPECT_EQ(apart->attempt.places->back().front(), ImageId{kLeft});
    EXPECT_FALSE(parts_of(contested(2))) << "two of ten are missing in models with reflections";
    EXPECT_FALSE(parts_of(contested(0)));
    EXPECT_FALSE(parts_of(judged(4))) << "nothing would explain how else they belong together";
}

TEST(InParts, EachIsJudgedAlone) {
    const Judged model = contested(4);
    const auto apart = parts_of(model);
    ASSERT_TRUE(apart);
    EXPECT_EQ(model.score.missing, 4 * kLeft * (kImages - kLeft));
    EXPECT_EQ(apart->score.missing, 0U);
    EXPECT_EQ(apart->score.regions, model.score.regions - 10 * kLeft * (kImages - kLeft));
    EXPECT_EQ(apart->score.images, kImages);
    EXPECT_LT(apart->score.observations, model.score.observations) << "of points within a part";
    EXPECT_TRUE(apart->score.in_places);
    EXPECT_TRUE(apart->score.is_doubted());
}

/// Of 100 points that are seen from both sides of a third image, 80 are shared by images of one
/// half, and so many by images of both. An edge between the outermost images is denied.
std::vector<Cut> tried_cuts(std::uint32_t shared_across, double relative) {
    Judged model = judged(4);
    for (const ComparedPair& pair : model.compared) {
        const bool is_across = pair.first < kLeft && pair.second >= kLeft;
        model.between.push_back({pair.first, pair.second, 100, is_across ? shared_across : 80});
    }
    model.edges.push_back({0, kImages - 1, nullptr, 0.0, relative, 1.0, false});
    return cuts_to_try(model, {});
}

TEST(CutsToTry, AreThoseWithAnotherExplanation) {
    EXPECT_TRUE(cuts_to_try(judged(4), {}).empty()) << "nothing would join the halves again";
    EXPECT_TRUE(tried_cuts(80, 0.05).empty()) << "they hold, and next to nothing would";
    EXPECT_FALSE(tried_cuts(80, 0.5).empty());
    const auto cuts = tried_cuts(40, 0.05);
    ASSERT_FALSE(cuts.empty()) << "they do not hold";
    EXPECT_EQ(cuts.front().images, kLeft) << "most is missing between the halves";
}

}  // namespace
}  // namespace psfm
