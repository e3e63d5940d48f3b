// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/look_alikes/look_alike_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "tests/synthetic/verified_pairs.h"

namespace psfm::synthetic {
namespace {

std::vector<LookAlikePair> all_pairs(const LookAlikeScene& scene,
                                     const LookAlikeMatchOptions& options = {}) {
    const LookAlikeIndex index = index_looks(scene);
    std::vector<LookAlikePair> pairs;
    for (std::uint32_t i = 0; i < scene.scene.images.size(); ++i) {
        std::ranges::copy(pairs_with_later(scene, index, ImageId{i}, options),
                          std::back_inserter(pairs));
    }
    return pairs;
}

/// How many features of one image have a feature of equal look, but no equal point, in another.
std::size_t common_looks(const LookAlikeScene& scene, ImagePair pair) {
    std::map<std::uint32_t, std::uint32_t> of_second;
    for (const std::uint32_t point : scene.scene.images[index_of(pair.second)].feature_point) {
        of_second[scene.looks[point]] = point;
    }
    std::size_t count = 0;
    for (const std::uint32_t point : scene.scene.images[index_of(pair.first)].feature_point) {
        const auto found = of_second.find(scene.looks[point]);
        count += found != of_second.end() && found->second != point ? 1 : 0;
    }
    return count;
}

/// What SIFT's matches say about temple-341, mean over pairs.
TEST(TemplePairs, FallOffAsMeasured) {
    const LookAlikeScene scene = make_temple({.images = 360}, 7);
    const LookAlikeIndex index = index_looks(scene);
    std::vector<double> right(361, 0.0);
    std::vector<double> copied(361, 0.0);
    constexpr std::uint32_t kFrom = 24;  // images, a fifteenth of the ring
    for (std::uint32_t from = 0; from < kFrom; ++from) {
        const ImageId image{from * 3};
        for (const LookAlikePair& pair :
             pairs_with_later(scene, index, image, {.min_matches = 1, .wrong_part = 0.0})) {
            const std::uint32_t degrees = index_of(pair.pair.second) - index_of(image);
            right[degrees] += pair.right / static_cast<double>(kFrom);
            copied[degrees] += pair.copied / static_cast<double>(kFrom);
        }
    }
    const std::map<std::size_t, double> measured{
        {1, 1393}, {5, 574}, {10, 356}, {20, 150}, {30, 63}};
    for (const auto& [degrees, matches] : measured) {
        EXPECT_NEAR(right[degrees] / matches, 1.0, 0.12) << degrees << " degrees";
    }
    EXPECT_LT(right[45], 15.0);
    EXPECT_EQ(right[60] + right[120] + right[180], 0.0);
    for (const std::size_t degrees : {60U, 120U, 180U, 240U}) {
        EXPECT_NEAR(copied[degrees] / 177.0, 1.0, 0.12) << degrees << " degrees";
    }
    EXPECT_NEAR(copied[45], 50.0, 12.0);
    EXPECT_NEAR(copied[75], 50.0, 12.0);
    EXPECT_NEAR(copied[90], 30.0, 10.0);
    EXPECT_EQ(copied[1], 0.0);
}

TEST(LookAlikePairs, MatchEachFeatureAtMostOnce) {
    for (const LookAlikeScene& scene :
         {make_temple({.images = 24, .symmetry = 12}, 1), make_courtyard({.images = 40}, 1),
          make_streets({.images = 200, .copied_facades = 0.5}, 1)}) {
        const std::vector<LookAlikePair> pairs = all_pairs(scene);
        ASSERT_FALSE(pairs.empty());
        EXPECT_TRUE(std::ranges::is_sorted(pairs, {}, &LookAlikePair::pair));
        for (const LookAlikePair& pair : pairs) {
            EXPECT_TRUE(std::ranges::is_sorted(pair.matches));
            std::set<std::uint32_t> first;
            std::set<std::uint32_t> second;
            for (const FeatureMatch& match : pair.matches) {
                first.insert(match.first);
                second.insert(match.second);
            }
            EXPECT_EQ(first.size(), pair.matches.size());
            EXPECT_EQ(second.size(), pair.matches.size());
            EXPECT_EQ(pair.right + pair.copied + pair.wrong, pair.matches.size());
            EXPECT_GE(pair.agreeing, 15U);
        }
    }
}

TEST(LookAlikePairs, HoldAllTrueMatchesAndTheCopiesBesides) {
    const LookAlikeScene scene = make_temple({.images = 20}, 3);
    std::size_t with_both = 0;
    for (const LookAlikePair& pair : all_pairs(scene, {.wrong_part = 0.0})) {
        const std::vector<FeatureMatch> truth = true_matches(scene.scene, pair.pair);
        EXPECT_EQ(truth.size(), pair.right);
        EXPECT_TRUE(std::ranges::includes(pair.matches, truth));
        EXPECT_EQ(pair.copied, common_looks(scene, pair.pair));
        with_both += pair.right > 0 && pair.copied > 0 ? 1 : 0;
    }
    EXPECT_GT(with_both, 0U);
}

TEST(LookAlikePairs, TellWhatMostOfThemAgreeOn) {
    const LookAlikeScene scene = make_temple({.images = 36}, 4);
    std::size_t folded = 0;
    for (const LookAlikePair& pair : all_pairs(scene)) {
        const auto steps = static_cast<int>(index_of(pair.pair.second)) -
                           static_cast<int>(index_of(pair.pair.first));
        // Ten degrees a step, six steps a side.
        EXPECT_EQ(pair.folded, steps >= 4 && steps <= 32) << steps;
        const Rigid3& pose1 = scene.scene.images[index_of(pair.pair.first)].cam_from_world;
        const Rigid3& pose2 = scene.scene.images[index_of(pair.pair.second)].cam_from_world;
        const Rigid3 truth = pose2 * inverse(pose1);
        const double angle = angle_between(truth.rotation, pair.cam2_from_cam1.rotation);
        if (!pair.folded) {
            EXPECT_LT(angle, 1e-9);
            EXPECT_GE(pair.right, pair.agreeing);
            continue;
        }
        ++folded;
        EXPECT_GT(angle * 180.0 / M_PI, 40.0);
        // Undone by a whole number of sides, turned about the temple's axis.
        const Rigid3 side = inverse(pose2) * pair.cam2_from_cam1 * pose1;
        const double turn = std::abs(Eigen::AngleAxisd(side.rotation).angle()) * 180.0 / M_PI;
        EXPECT_NEAR(std::remainder(turn, 60.0), 0.0, 1e-6);
        EXPECT_LT(side.translation.norm(), 1e-9);
    }
    EXPECT_GT(folded, 300U);
}

TEST(LookAlikePairs, AreAmbiguousWhereOneImageSeesBothCopies) {
    // A twelfth of a turn apart, sides are in view together; the ratio test then takes neither.
    const LookAlikeScene scene = make_temple({.images = 24, .symmetry = 24, .max_deg = 60.0}, 5);
    const LookAlikeIndex index = index_looks(scene);
    std::size_t ambiguous = 0;
    for (const LookAlikePair& pair : pairs_with_later(scene, index, ImageId{0}, {})) {
        std::map<std::uint32_t, int> features_of_look;
        const auto& points1 = scene.scene.images[0].feature_point;
        const auto& points2 = scene.scene.images[index_of(pair.pair.second)].feature_point;
        for (const std::uint32_t point : points1) ++features_of_look[scene.looks[point]];
        for (const FeatureMatch& match : pair.matches) {
            const std::uint32_t look = scene.looks[points1[match.first]];
            if (features_of_look[look] < 2 || look != scene.looks[points2[match.second]]) continue;
            ++ambiguous;
            EXPECT_EQ(points1[match.first], points2[match.second]);
        }
    }
    EXPECT_GT(ambiguous, 50U);
}

TEST(LookAlikePairs, HaveAFewWrongSingles) {
    const LookAlikeScene scene = make_courtyard({.images = 30}, 1);
    std::size_t wrong = 0;
    std::size_t all = 0;
    for (const LookAlikePair& pair : all_pairs(scene, {.wrong_part = 0.1})) {
        wrong += pair.wrong;
        all += pair.matches.size();
    }
    const double part = static_cast<double>(wrong) / static_cast<double>(all);
    EXPECT_GT(part, 0.04);
    EXPECT_LE(part, 0.1);
    for (const LookAlikePair& pair : all_pairs(scene, {.wrong_part = 0.0}))
        EXPECT_EQ(pair.wrong, 0U);
}

/// The promise that lets 10,000 images and more be simulated.
TEST(StreetsPairs, AreAsManyAnImageInALargerTown) {
    std::vector<double> an_image;
    for (const std::uint32_t images : {800U, 3200U}) {
        const LookAlikeScene scene = make_streets({.images = images, .points_per_metre = 150.0}, 1);
        const LookAlikeIndex index = index_looks(scene);
        // Of every fourth image with later ones: half of all its pairs.
        double pairs = 0.0;
        std::size_t folded = 0;
        for (std::uint32_t i = 0; i < images; i += 4) {
            for (const LookAlikePair& pair : pairs_with_later(scene, index, ImageId{i}, {})) {
                pairs += pair.folded ? 0.0 : 1.0;
                folded += pair.folded ? 1 : 0;
            }
        }
        EXPECT_GT(folded, 0U);
        an_image.push_back(8.0 * pairs / images);
        EXPECT_GT(an_image.back(), 10.0);
        EXPECT_LT(an_image.back(), 60.0);
    }
    EXPECT_LT(an_image[1], 2.0 * an_image[0]);
}

TEST(LookAlikePairs, OfOneSceneHangTogether) {
    for (const LookAlikeScene& scene :
         {make_temple({.images = 40}, 2), make_courtyard({.images = 60}, 2),
          make_streets({.images = 250}, 2)}) {
        std::vector<std::size_t> parent(scene.scene.images.size());
        std::iota(parent.begin(), parent.end(), std::size_t{0});
        const auto root = [&](std::size_t i) {
            while (parent[i] != i) i = parent[i] = parent[parent[i]];
            return i;
        };
        for (const LookAlikePair& pair : all_pairs(scene)) {
            if (!pair.folded)
                parent[root(index_of(pair.pair.first))] = root(index_of(pair.pair.second));
        }
        for (std::size_t i = 0; i < parent.size(); ++i) EXPECT_EQ(root(i), root(0)) << i;
    }
}

}  // namespace
}  // namespace psfm::synthetic
