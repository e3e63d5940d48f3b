// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/descriptor_cells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>
#include <string>

#include "stages/algorithms/matching/match_with_kernel.h"
#include "tests/stages/verification/random_descriptors.h"

namespace psfm {
namespace {

using testing::IsEmpty;

/// Small cells, from the first row on, so that small images have many.
constexpr CellOptions kSmallCells{.min_rows = 1, .rows_per_cell = 16, .min_strongest_matches = 0};

/// Two images of which half of the features are common.
struct TwoImages {
    Descriptors a;
    Descriptors b;
};

TwoImages two_images(std::size_t rows, std::uint32_t seed) {
    TwoImages images{random_root_sift(rows, seed), {}};
    std::vector<std::size_t> source;
    images.b = shuffled_and_noisy(images.a, source, 14, seed + 1);
    images.b.values.resize(rows / 2 * Descriptors::kSize);
    const Descriptors others = random_root_sift(rows - rows / 2, seed + 2);
    images.b.values.insert(images.b.values.end(), others.values.begin(), others.values.end());
    return images;
}

class EveryKernel : public testing::TestWithParam<NamedDotKernel> {
  protected:
    static std::vector<FeatureMatch> match(const Descriptors& a, const Descriptors& b,
                                           const CellOptions& cells,
                                           const MatchOptions& options = {}) {
        return match_in_cells_with_kernel(a, divide(b, cells), options, cells, GetParam()).value();
    }
};

INSTANTIATE_TEST_SUITE_P(DescriptorCells, EveryKernel, testing::ValuesIn(available_dot_kernels()),
                         [](const auto& kernel) { return std::string(kernel.param.name); });

TEST_P(EveryKernel, KeysAreDistancesForEveryRemainderOfTheTile) {
    for (const std::size_t rows : {1, 3, 8, 31, 33, 70}) {
        for (const std::size_t columns : {1, 15, 16, 17, 48, 49, 100}) {
            const Descriptors a = random_root_sift(rows, static_cast<std::uint32_t>(rows));
            const Descriptors b = random_root_sift(columns, 500 + static_cast<std::uint32_t>(rows));
            const PackedDescriptors packed = pack(b);
            const std::vector<std::int32_t> norms = pack(a).norms;
            std::vector<std::int32_t> sums(rows);
            for (std::size_t i = 0; i < rows; ++i)
                sums[i] = std::accumulate(a.row(i), a.row(i) + Descriptors::kSize, 0);
            DotKernelInput input;
            input.rows = a.values.data();
            input.row_norms = norms.data();
            input.row_sums = sums.data();
            input.row_count = rows;
            input.strips = packed.strips.data();
            input.column_norms = packed.norms.data();
            input.column_count = columns;
            const std::size_t strips = strip_count(columns);
            std::vector<StripKeys> keys(rows * strips);
            GetParam().distances(input, keys.data());
            for (std::size_t i = 0; i < rows; ++i) {
                for (std::size_t j = 0; j < strips * kStripColumns; ++j) {
                    const std::int32_t key =
                        keys[i * strips + j / kStripColumns].lane[j % kStripColumns];
                    if (j >= columns) {
                        ASSERT_EQ(key, std::numeric_limits<std::int32_t>::max());
                        continue;
                    }
                    std::int32_t product = 0;
                    for (std::size_t k = 0; k < Descriptors::kSize; ++k)
                        product += a.row(i)[k] * b.row(j)[k];
                    ASSERT_EQ(key >> 8, packed.norms[j] - 2 * product) << i << ", " << j;
                }
            }
        }
    }
}

TEST_P(EveryKernel, ComparingAllCellsGivesAllMatches) {
    CellOptions everything = kSmallCells;
    everything.max_excess = 4.0;
    for (const std::size_t rows : {1, 2, 17, 300, 700}) {
        const TwoImages images = two_images(rows, static_cast<std::uint32_t>(rows));
        EXPECT_EQ(match(images.a, images.b, everything), match_descriptors(images.a, images.b, {}));
    }
}

TEST_P(EveryKernel, FewCellsGiveNearlyTheSame) {
    const TwoImages images = two_images(2000, 3);
    const auto all = match_descriptors(images.a, images.b, {});
    ASSERT_GT(all.size(), 800U);
    const auto common_with_all = [&](const std::vector<FeatureMatch>& found) {
        EXPECT_TRUE(std::ranges::is_sorted(found, {}, &FeatureMatch::first));
        std::vector<FeatureMatch> common;
        std::ranges::set_intersection(all, found, std::back_inserter(common));
        return common.size();
    };
    const auto found = match(images.a, images.b, kSmallCells);
    EXPECT_GT(common_with_all(found), all.size() * 95 / 100);
    EXPECT_LT(found.size(), all.size() * 102 / 100);

    CellOptions nearest_only = kSmallCells;
    nearest_only.max_excess = 0.0;
    EXPECT_LT(common_with_all(match(images.a, images.b, nearest_only)), common_with_all(found))
        << "the limit has no effect";
}

TEST_P(EveryKernel, ComparingTheStrongestFirstChangesNoMatch) {
    const TwoImages images = two_images(1000, 5);
    CellOptions strongest_first = kSmallCells;
    strongest_first.strongest_rows = 250;
    strongest_first.min_strongest_matches = 1;
    EXPECT_EQ(match(images.a, images.b, strongest_first), match(images.a, images.b, kSmallCells));
}

TEST_P(EveryKernel, EmptySidesGiveNoMatches) {
    const Descriptors some = random_root_sift(5, 1);
    EXPECT_THAT(match({}, some, kSmallCells), IsEmpty());
    EXPECT_THAT(match(some, {}, kSmallCells), IsEmpty());
}

TEST(DescriptorCells, EveryDescriptorIsInOneCell) {
    const Descriptors descriptors = random_root_sift(1000, 4);
    const PackedDescriptors packed = pack(descriptors);
    const DescriptorCells divided = divide(descriptors, kSmallCells);
    EXPECT_GT(divided.cells.size(), 40U);
    EXPECT_EQ(divided.centres.rows, divided.cells.size());
    std::set<std::uint32_t> seen;
    for (const DescriptorCells::Cell& cell : divided.cells) {
        EXPECT_EQ(cell.first_column % (kStripColumns * kStripGroup), 0U);
        EXPECT_GT(cell.rows, 0U);
        for (std::size_t j = cell.first_column; j < cell.first_column + cell.rows; ++j) {
            EXPECT_TRUE(seen.insert(divided.row_of_column[j]).second);
            EXPECT_EQ(divided.norms[j], packed.norms[divided.row_of_column[j]]);
        }
    }
    EXPECT_EQ(seen.size(), 1000U);
    EXPECT_TRUE(divide({}, kSmallCells).cells.empty());
}

TEST(DescriptorCells, EqualDescriptorsShareACell) {
    Descriptors descriptors;
    descriptors.values.assign(200 * Descriptors::kSize, 45);
    const DescriptorCells divided = divide(descriptors, kSmallCells);
    ASSERT_EQ(divided.cells.size(), 1U);
    EXPECT_EQ(divided.cells[0].rows, 200U);
}

TEST(MatchImages, SmallImagesAreComparedWhole) {
    const TwoImages images = two_images(500, 7);
    CellOptions cells = kSmallCells;
    cells.max_excess = 0.0;
    cells.min_rows = 501;
    const auto match = [&](bool divide_b) {
        return *match_images(images.a, images.b, prepare(images.b, cells), divide_b, {}, cells);
    };
    const auto all = match_descriptors(images.a, images.b, {});
    EXPECT_EQ(match(true), all);
    EXPECT_EQ(match(false), all);
    EXPECT_TRUE(prepare(images.b, cells).cells.cells.empty());
    cells.min_rows = 500;
    EXPECT_LT(match(true).size(), all.size());
}

TEST(MatchImages, PairsWithFewMatchesOfTheStrongestAreHopeless) {
    // The first quarter of one image has nothing in common with the other, all else has.
    const TwoImages images = two_images(800, 11);
    Descriptors a = random_root_sift(200, 77);
    a.values.insert(a.values.end(), images.a.values.begin(), images.a.values.end());
    CellOptions cells = kSmallCells;
    cells.strongest_rows = 200;
    const auto match = [&](std::size_t at_least) {
        cells.min_strongest_matches = at_least;
        return match_images(a, images.b, prepare(images.b, cells), true, {}, cells);
    };
    ASSERT_TRUE(match(0).has_value());
    EXPECT_GT(match(0)->size(), 300U);
    EXPECT_FALSE(match(8).has_value());
    cells.strongest_rows = 400;
    EXPECT_TRUE(match(8).has_value());
    cells.min_rows = 5000;
    cells.strongest_rows = 200;
    EXPECT_TRUE(match(8).has_value()) << "images that are compared whole are compared at once";
}

TEST(MatchImages, ExchangingTheImagesExchangesTheMatches) {
    const TwoImages images = two_images(1500, 9);
    for (const bool divide_b : {true, false}) {
        const auto straight = *match_images(images.a, images.b, prepare(images.b, kSmallCells),
                                            divide_b, {}, kSmallCells);
        auto swapped = *match_images(images.b, images.a, prepare(images.a, kSmallCells), !divide_b,
                                     {}, kSmallCells);
        EXPECT_TRUE(std::ranges::is_sorted(swapped, {}, &FeatureMatch::first));
        for (FeatureMatch& match : swapped) std::swap(match.first, match.second);
        std::ranges::sort(swapped, {}, &FeatureMatch::first);
        EXPECT_EQ(straight, swapped);
        EXPECT_GT(straight.size(), 500U);
    }
}

TEST(CellOptions, RefusesNonsense) {
    EXPECT_TRUE(validate(CellOptions{}).ok());
    EXPECT_FALSE(validate(CellOptions{.rows_per_cell = 0}).ok());
    EXPECT_FALSE(validate(CellOptions{.max_excess = -0.1}).ok());
    EXPECT_FALSE(validate(CellOptions{.max_excess = 5.0}).ok());
    EXPECT_FALSE(validate(CellOptions{.strongest_rows = 0}).ok());
}

}  // namespace
}  // namespace psfm
