// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/match_descriptors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "stages/algorithms/matching/match_with_kernel.h"
#include "tests/stages/verification/random_descriptors.h"

namespace psfm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::int64_t squared_distance(const std::uint8_t* a, const std::uint8_t* b) {
    std::int64_t sum = 0;
    for (std::size_t k = 0; k < Descriptors::kSize; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

struct Nearest {
    std::size_t index = 0;
    std::int64_t best = std::numeric_limits<std::int64_t>::max();
    std::int64_t second = std::numeric_limits<std::int64_t>::max();
};

Nearest nearest(const std::uint8_t* query, const Descriptors& others) {
    Nearest found;
    for (std::size_t j = 0; j < others.rows(); ++j) {
        const std::int64_t distance = squared_distance(query, others.row(j));
        if (distance < found.best) {
            found.second = found.best;
            found.best = distance;
            found.index = j;
        } else {
            found.second = std::min(found.second, distance);
        }
    }
    return found;
}

/// The contract of match_descriptors(), word by word and without any cleverness.
std::vector<FeatureMatch> match_by_brute_force(const Descriptors& a, const Descriptors& b,
                                               const MatchOptions& options) {
    std::vector<FeatureMatch> matches;
    if (b.rows() == 0) return matches;
    for (std::size_t i = 0; i < a.rows(); ++i) {
        const Nearest of_a = nearest(a.row(i), b);
        const Nearest of_b = nearest(b.row(of_a.index), a);
        const auto best = static_cast<double>(of_a.best);
        const double squared_ratio = options.max_ratio * options.max_ratio;
        if (of_b.index == i && best <= std::pow(512.0 * options.max_distance, 2) &&
            (b.rows() == 1 || best < squared_ratio * static_cast<double>(of_a.second)) &&
            (a.rows() == 1 || best < squared_ratio * static_cast<double>(of_b.second))) {
            matches.push_back(
                {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(of_a.index)});
        }
    }
    return matches;
}

class EveryKernel : public testing::TestWithParam<NamedDotKernel> {
  protected:
    static std::vector<FeatureMatch> match(const Descriptors& a, const Descriptors& b,
                                           const MatchOptions& options) {
        return match_with_kernel(a, pack(b), options, GetParam().kernel);
    }
};

INSTANTIATE_TEST_SUITE_P(MatchDescriptors, EveryKernel, testing::ValuesIn(available_dot_kernels()),
                         [](const auto& kernel) { return std::string(kernel.param.name); });

TEST_P(EveryKernel, AddsUpEachRowsBytesAndTheirSquares) {
    for (const auto& [low, high] : {std::pair{0, 255}, {255, 255}, {0, 0}, {120, 135}}) {
        const Descriptors rows = random_bytes(19, low, high, 9);
        std::vector<std::int32_t> sums(rows.rows(), -1);
        std::vector<std::int32_t> norms(rows.rows(), -1);
        GetParam().row_sums(rows.values.data(), rows.rows(), sums.data(), norms.data());
        const Descriptors origin = random_bytes(1, 0, 0, 1);
        for (std::size_t i = 0; i < rows.rows(); ++i) {
            const std::uint8_t* row = rows.row(i);
            EXPECT_EQ(sums[i], std::accumulate(row, row + Descriptors::kSize, 0));
            EXPECT_EQ(norms[i], squared_distance(row, origin.row(0)));
        }
    }
}

TEST_P(EveryKernel, AgreesWithBruteForceForEveryRemainderOfTheTile) {
    const MatchOptions options{.max_ratio = 0.95, .max_distance = 0.7};
    std::size_t matches = 0;
    for (const std::size_t a_rows : {1, 2, 3, 7, 8, 9, 15, 16, 17, 31, 32, 33, 47, 48, 49, 97}) {
        for (const std::size_t b_rows : {1, 2, 5, 8, 15, 16, 17, 32, 47, 48, 49, 64, 95, 96, 97}) {
            const auto seed = static_cast<std::uint32_t>(a_rows * 1000 + b_rows);
            Descriptors a = random_root_sift(a_rows, seed);
            std::vector<std::size_t> source;
            Descriptors b = shuffled_and_noisy(a, source, 12, seed + 1);
            const Descriptors others = random_root_sift(b_rows, seed + 2);
            b.values.insert(b.values.end(), others.values.begin(), others.values.end());
            b.values.resize(b_rows * Descriptors::kSize);
            const auto expected = match_by_brute_force(a, b, options);
            ASSERT_EQ(match(a, b, options), expected) << a_rows << " x " << b_rows;
            matches += expected.size();
        }
    }
    EXPECT_GT(matches, 1000U);  // the comparison was about something
}

TEST_P(EveryKernel, AgreesWithBruteForceAcrossBlocksOfRowsAndColumns) {
    // More rows than one block of 256, more columns than one block of 255 strips (4,080).
    const MatchOptions options{.max_ratio = 0.9, .max_distance = 0.7};
    const Descriptors a = random_root_sift(290, 1);
    std::vector<std::size_t> source;
    Descriptors b = random_root_sift(3900, 2);
    const Descriptors again = shuffled_and_noisy(a, source, 15, 3);
    b.values.insert(b.values.end(), again.values.begin(), again.values.end());
    const auto expected = match_by_brute_force(a, b, options);
    EXPECT_GT(expected.size(), 250U);
    EXPECT_EQ(match(a, b, options), expected);
    const auto swapped = match_by_brute_force(b, a, options);
    EXPECT_EQ(match(b, a, options), swapped);
}

TEST_P(EveryKernel, IsExactForTheLargestBytes) {
    // Sums of products up to 128 * 255^2: beyond what saturating 16-bit or signed 8-bit arithmetic
    // holds.
    const MatchOptions options{.max_ratio = 1.0, .max_distance = 2.0};
    for (const auto& [low, high] :
         {std::pair{0, 255}, {250, 255}, {127, 129}, {255, 255}, {0, 0}}) {
        const Descriptors a = random_bytes(70, low, high, 5);
        std::vector<std::size_t> source;
        const Descriptors b = shuffled_and_noisy(a, source, 3, 6);
        EXPECT_EQ(match(a, b, options), match_by_brute_force(a, b, options)) << low << ".." << high;
    }
    Descriptors black = random_bytes(20, 0, 0, 1);
    const Descriptors white = random_bytes(20, 255, 255, 1);
    EXPECT_THAT(match(black, white, options), IsEmpty());
    black.values[0] = 255;  // one row nearer than the others
    EXPECT_EQ(match(black, white, options), match_by_brute_force(black, white, options));
}

TEST_P(EveryKernel, ManyEqualDistancesKeepTheLowestIndex) {
    // Three values a byte make ties common, near the middle and across blocks.
    const MatchOptions options{.max_ratio = 1.0, .max_distance = 2.0};
    Descriptors a = random_bytes(300, 0, 1, 7);
    Descriptors b = random_bytes(300, 0, 1, 8);
    for (std::size_t i = 0; i < a.values.size();
         ++i) {  // two informative bytes a row: few distinct rows
        if (i % Descriptors::kSize > 5) a.values[i] = b.values[i] = 3;
    }
    EXPECT_EQ(match(a, b, options), match_by_brute_force(a, b, options));
}

TEST_P(EveryKernel, EmptySidesGiveNoMatches) {
    const Descriptors some = random_root_sift(5, 1);
    EXPECT_THAT(match({}, some, {}), IsEmpty());
    EXPECT_THAT(match(some, {}, {}), IsEmpty());
    EXPECT_THAT(match({}, {}, {}), IsEmpty());
}

TEST(MatchDescriptors, FindsAPlantedPermutation) {
    const Descriptors a = random_root_sift(500, 11);
    std::vector<std::size_t> source;
    const Descriptors b = shuffled_and_noisy(a, source, 5, 12);
    const auto matches = match_descriptors(a, b, {});
    ASSERT_EQ(matches.size(), 500U);
    for (const FeatureMatch& match : matches) EXPECT_EQ(source[match.second], match.first);
    EXPECT_TRUE(std::is_sorted(matches.begin(), matches.end()));
}

TEST(MatchDescriptors, SwappingTheImagesSwapsTheMatches) {
    const Descriptors a = random_root_sift(333, 13);
    std::vector<std::size_t> source;
    const Descriptors b = shuffled_and_noisy(a, source, 25, 14);
    auto matches = match_descriptors(b, a, {});
    for (FeatureMatch& match : matches) std::swap(match.first, match.second);
    std::sort(matches.begin(), matches.end());
    EXPECT_EQ(match_descriptors(a, b, {}), matches);
    EXPECT_FALSE(matches.empty());
}

TEST(MatchDescriptors, RepeatedStructureFailsTheRatioTest) {
    Descriptors a = random_root_sift(10, 15);
    const Descriptors b = a;
    ASSERT_EQ(match_descriptors(a, b, {}).size(), 10U);
    std::copy_n(a.row(3), Descriptors::kSize,
                a.values.begin() + 7 * Descriptors::kSize);  // 7 now equals 3
    std::vector<std::uint32_t> first;
    for (const FeatureMatch& match : match_descriptors(a, b, {})) first.push_back(match.first);
    EXPECT_THAT(first, ElementsAre(0, 1, 2, 4, 5, 6, 8, 9));
}

TEST(MatchDescriptors, DistanceLimitIsOnUnitLength) {
    // One byte differs by 100: distance 100 / 512 = 0.1953.
    Descriptors a;
    a.values.assign(Descriptors::kSize, 45);
    Descriptors b = a;
    b.values[0] = 145;
    EXPECT_THAT(match_descriptors(a, b, {.max_ratio = 0.8, .max_distance = 0.196}),
                ElementsAre(FeatureMatch{0, 0}));
    EXPECT_THAT(match_descriptors(a, b, {.max_ratio = 0.8, .max_distance = 0.195}), IsEmpty());
}

TEST(MatchDescriptors, PackedCopyMatchesLikeTheOriginal) {
    const Descriptors a = random_root_sift(50, 18);
    const PackedDescriptors packed = pack(a);
    const std::vector<PackedDescriptors> copies(3,
                                                packed);  // moved in memory: alignment must survive
    for (const PackedDescriptors& copy : copies)
        EXPECT_EQ(match_descriptors(a, copy, {}).size(), 50U);
}

TEST(MatchDescriptors, OptionsOutsideTheirRangeAreNamed) {
    EXPECT_TRUE(validate(MatchOptions{}).ok());
    for (const MatchOptions& bad : {MatchOptions{.max_ratio = 0.0}, MatchOptions{.max_ratio = 1.1},
                                    MatchOptions{.max_ratio = std::nan("")}}) {
        ASSERT_FALSE(validate(bad).ok());
        EXPECT_THAT(validate(bad).error().message, testing::HasSubstr("max_ratio"));
    }
    const MatchOptions far{.max_ratio = 0.8, .max_distance = 2.5};
    EXPECT_THAT(validate(far).error().message, testing::HasSubstr("max_distance"));
}

}  // namespace
}  // namespace psfm
