// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/run_verification.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "stages/algorithms/two_view/invert_two_view_geometry.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/scene.h"

namespace psfm {
namespace {

/// Images of a ring about a ball: neighbours see the same side, opposite ones nothing in common.
std::vector<ImageFeatures> make_images(std::uint32_t count = 8) {
    synthetic::SceneOptions options = synthetic::ring_around_sphere(count);
    options.visibility.max_features = 300;
    const synthetic::SyntheticScene scene =
        add_clutter(add_pixel_noise(make_scene(options, 4), 0.4, 5), 60, 6);
    std::vector<ImageFeatures> images;
    for (std::uint32_t i = 0; i < scene.images.size(); ++i) {
        const auto id = ImageId{i};
        ImageFeatures image{id, scene.camera_of(id), synthetic::mix_seed(99, i), nullptr, nullptr};
        image.camera.focal_source = FocalSource::kGiven;
        image.keypoints = std::make_shared<const Keypoints>(scene.images[i].keypoints);
        image.descriptors = std::make_shared<const Descriptors>(make_descriptors(scene, id, 0.1));
        images.push_back(std::move(image));
    }
    return images;
}

VerificationInput last_against_all(const std::vector<ImageFeatures>& images) {
    VerificationInput input;
    input.image = images.back();
    for (std::size_t i = 0; i + 1 < images.size(); ++i) input.candidates.push_back(images[i].id);
    input.load = loader_of(images);
    input.seed = 7;
    return input;
}

void expect_equal(const TwoViewGeometry& a, const TwoViewGeometry& b) {
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.inliers, b.inliers);
    EXPECT_EQ(a.matrix, b.matrix);
    EXPECT_EQ(a.cam2_from_cam1.rotation.coeffs(), b.cam2_from_cam1.rotation.coeffs());
    EXPECT_EQ(a.cam2_from_cam1.translation, b.cam2_from_cam1.translation);
    EXPECT_EQ(a.median_angle_deg, b.median_angle_deg);
}

void expect_equal(const VerificationOutput& a, const VerificationOutput& b) {
    ASSERT_EQ(a.pairs.size(), b.pairs.size());
    for (std::size_t i = 0; i < a.pairs.size(); ++i) {
        EXPECT_EQ(a.pairs[i]->pair, b.pairs[i]->pair);
        expect_equal(a.pairs[i]->geometry, b.pairs[i]->geometry);
    }
}

TEST(RunVerification, FindsTheNeighboursAndCountsTheRest) {
    const std::vector<ImageFeatures> images = make_images();
    const Result<VerificationOutput> output = run_verification(last_against_all(images), {});
    ASSERT_TRUE(output.ok()) << output.error().message;
    ASSERT_GE(output->pairs.size(), 2U);
    EXPECT_TRUE(std::ranges::is_sorted(output->pairs, {}, [](const auto& p) { return p->pair; }));
    const auto has = [&](std::uint32_t other) {
        return std::ranges::any_of(output->pairs, [&](const auto& p) {
            return p->pair == ImagePair::of(ImageId{other}, ImageId{7});
        });
    };
    EXPECT_TRUE(has(0));
    EXPECT_TRUE(has(6));
    EXPECT_FALSE(has(3)) << "the other side of the ball";
    const VerificationStatistics& s = output->statistics;
    EXPECT_EQ(s.tried, 7U);
    EXPECT_EQ(s.verified, output->pairs.size());
    EXPECT_EQ(s.verified + s.too_few_matches + s.degenerate + s.too_few_strongest, s.tried);
    EXPECT_GT(s.inliers, 100U);
    EXPECT_GE(s.putative_matches, s.inliers);
}

TEST(RunVerification, ThreadsDoNotChangeTheResult) {
    const std::vector<ImageFeatures> images = make_images();
    const auto on_threads = [&](std::size_t count) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, count);
        return run_verification(last_against_all(images), {});
    };
    const Result<VerificationOutput> one = on_threads(1);
    ASSERT_TRUE(one.ok()) << one.error().message;
    for (const std::size_t count : {2U, 4U}) {
        const Result<VerificationOutput> several = on_threads(count);
        ASSERT_TRUE(several.ok());
        expect_equal(*one, *several);
    }
}

TEST(RunVerification, OrderAndRepetitionOfCandidatesDoNotChangeTheResult) {
    const std::vector<ImageFeatures> images = make_images();
    VerificationInput input = last_against_all(images);
    const Result<VerificationOutput> straight = run_verification(input, {});
    std::ranges::reverse(input.candidates);
    input.candidates.push_back(ImageId{0});
    const Result<VerificationOutput> reversed = run_verification(input, {});
    ASSERT_TRUE(straight.ok() && reversed.ok());
    expect_equal(*straight, *reversed);
    EXPECT_EQ(reversed->statistics.tried, 7U);
}

/// A promise of docs/design.md: a pair verifies alike in every order of arrival.
void expect_inverse_geometry_when_exchanged(const VerificationOptions& options) {
    std::vector<ImageFeatures> images = make_images();
    for (const std::size_t other : {0U, 1U, 5U, 6U}) {
        ImageFeatures a = images[7];
        ImageFeatures b = images[other];
        const auto verify = [&](ImageFeatures first, ImageFeatures second) {
            first.id = ImageId{0};
            second.id = ImageId{1};
            VerificationInput input{second, {first.id}, loader_of({first}), 7};
            return run_verification(input, options);
        };
        const Result<VerificationOutput> ab = verify(a, b);
        const Result<VerificationOutput> ba = verify(b, a);
        ASSERT_TRUE(ab.ok() && ba.ok());
        ASSERT_EQ(ab->pairs.size(), ba->pairs.size());
        if (ab->pairs.empty()) continue;
        const TwoViewGeometry& straight = ab->pairs[0]->geometry;
        const TwoViewGeometry inverted = invert(ba->pairs[0]->geometry);
        EXPECT_EQ(straight.kind, inverted.kind);
        EXPECT_EQ(straight.inliers, inverted.inliers);
        EXPECT_LT((straight.matrix - inverted.matrix).norm(), 1e-12);
        EXPECT_LT(angle_between(straight.cam2_from_cam1.rotation, inverted.cam2_from_cam1.rotation),
                  1e-7);
        EXPECT_LT(
            (straight.cam2_from_cam1.translation - inverted.cam2_from_cam1.translation).norm(),
            1e-12);
        EXPECT_EQ(straight.median_angle_deg, inverted.median_angle_deg);
    }
}

TEST(RunVerification, ExchangedArrivalGivesTheInverseGeometryExactly) {
    expect_inverse_geometry_when_exchanged({});
    // Which image is divided into cells is not to depend on it either: one cell each way loses
    // matches.
    VerificationOptions in_cells;
    in_cells.cells = {.min_rows = 1, .rows_per_cell = 16, .max_excess = 0.0};
    expect_inverse_geometry_when_exchanged(in_cells);
}

TEST(RunVerification, CheapTestLeavesOutWhatHasNothingInCommon) {
    const std::vector<ImageFeatures> images = make_images();
    VerificationOptions everything;
    everything.cells = {.min_rows = 1, .rows_per_cell = 16, .min_strongest_matches = 0};
    VerificationOptions options = everything;
    options.cells.strongest_rows = 144;
    options.cells.min_strongest_matches = 6;
    const Result<VerificationOutput> all = run_verification(last_against_all(images), everything);
    const Result<VerificationOutput> some = run_verification(last_against_all(images), options);
    ASSERT_TRUE(all.ok() && some.ok());
    expect_equal(*all, *some);
    EXPECT_EQ(all->statistics.too_few_strongest, 0U);
    EXPECT_GT(some->statistics.too_few_strongest, 0U);
    // Small images are compared whole, at once.
    options.cells.min_rows = 1000;
    const Result<VerificationOutput> small = run_verification(last_against_all(images), options);
    ASSERT_TRUE(small.ok());
    EXPECT_EQ(small->statistics.too_few_strongest, 0U);
}

TEST(RunVerification, EndsTheSearchAmongRankedCandidatesWhenThereAreEnoughPairs) {
    // Neighbours on the ring, then those that show something else, then the others again.
    VerificationInput input = last_against_all(make_images());
    input.candidates = {ImageId{0}, ImageId{6}, ImageId{3}, ImageId{4}, ImageId{5}, ImageId{1}};
    VerificationOptions options;
    options.enough_pairs = 2;
    const Result<VerificationOutput> unranked = run_verification(input, options);
    ASSERT_TRUE(unranked.ok());
    EXPECT_EQ(unranked->statistics.tried, 6U) << "whose order means nothing";
    ASSERT_GT(unranked->pairs.size(), 3U);

    input.ranked = true;
    const Result<VerificationOutput> first_round = run_verification(input, options);
    ASSERT_TRUE(first_round.ok());
    EXPECT_EQ(first_round->statistics.tried, 2U);
    ASSERT_EQ(first_round->pairs.size(), 2U);
    EXPECT_EQ(first_round->pairs[0]->pair.first, ImageId{0});
    EXPECT_EQ(first_round->pairs[1]->pair.first, ImageId{6});

    options.enough_pairs = 3;  // rounds of three, one, one
    const Result<VerificationOutput> goes_on = run_verification(input, options);
    ASSERT_TRUE(goes_on.ok());
    EXPECT_EQ(goes_on->statistics.tried, 5U);
    EXPECT_EQ(goes_on->pairs.size(), 3U);

    options.enough_pairs = 0;
    const Result<VerificationOutput> all = run_verification(input, options);
    ASSERT_TRUE(all.ok());
    expect_equal(*all, *unranked);
}

TEST(RunVerification, LaterRoundsTryAsManyAsSeemToBeNeeded) {
    VerificationInput input = last_against_all(make_images(16));
    const Result<VerificationOutput> all = run_verification(input, {});
    ASSERT_TRUE(all.ok());
    std::vector<ImageId> good;
    for (const VerifiedPairPtr& pair : all->pairs) good.push_back(pair->pair.first);
    std::vector<ImageId> bad;
    std::ranges::copy_if(input.candidates, std::back_inserter(bad), [&](ImageId image) {
        return std::ranges::find(good, image) == good.end();
    });
    ASSERT_GE(good.size(), 7U);
    ASSERT_GE(bad.size(), 4U);
    // Six of seven hold in the first round: one more is had from two, most likely.
    input.candidates.assign(good.begin(), good.begin() + 6);
    input.candidates.push_back(bad[0]);
    input.candidates.push_back(good[6]);
    input.candidates.insert(input.candidates.end(), bad.begin() + 1, bad.end());
    input.ranked = true;
    VerificationOptions options;
    options.enough_pairs = 7;
    const Result<VerificationOutput> some = run_verification(input, options);
    ASSERT_TRUE(some.ok());
    EXPECT_EQ(some->pairs.size(), 7U);
    EXPECT_EQ(some->statistics.tried, 9U);
}

TEST(RunVerification, NoCandidates) {
    VerificationInput input = last_against_all(make_images());
    input.candidates.clear();
    const Result<VerificationOutput> output = run_verification(input, {});
    ASSERT_TRUE(output.ok());
    EXPECT_TRUE(output->pairs.empty());
    EXPECT_EQ(output->statistics.tried, 0U);
}

TEST(RunVerification, ReportsTheLoadersFirstError) {
    const std::vector<ImageFeatures> images = make_images();
    VerificationInput input = last_against_all(images);
    input.load = [good = loader_of(images)](ImageId id) -> Result<ImageFeatures> {
        if (id == ImageId{2}) return Error{ErrorCode::kDamaged, "record of image 2"};
        if (id == ImageId{4}) return Error{ErrorCode::kIo, "record of image 4"};
        return good(id);
    };
    const Result<VerificationOutput> output = run_verification(input, {});
    ASSERT_FALSE(output.ok());
    EXPECT_EQ(output.error().code, ErrorCode::kDamaged);
}

TEST(RunVerification, TurnsExceptionsIntoErrors) {
    VerificationInput input = last_against_all(make_images());
    input.load = [](ImageId) -> Result<ImageFeatures> { throw std::runtime_error("out of luck"); };
    const Result<VerificationOutput> output = run_verification(input, {});
    ASSERT_FALSE(output.ok());
    EXPECT_EQ(output.error().code, ErrorCode::kInternal);
    EXPECT_NE(output.error().message.find("out of luck"), std::string::npos);
}

TEST(RunVerification, NamesBadInput) {
    const std::vector<ImageFeatures> images = make_images();
    VerificationInput own = last_against_all(images);
    own.candidates.push_back(own.image.id);
    EXPECT_EQ(run_verification(own, {}).error().code, ErrorCode::kInvalidArgument);
    VerificationInput without = last_against_all(images);
    without.image.descriptors = nullptr;
    EXPECT_EQ(run_verification(without, {}).error().code, ErrorCode::kInvalidArgument);
    VerificationOptions options;
    options.verify.confidence = 1.0;
    EXPECT_EQ(run_verification(last_against_all(images), options).error().code,
              ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace psfm
