// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/scene_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <map>
#include <memory>
#include <ranges>
#include <set>
#include <utility>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

using synthetic::Rng;
using Points = std::vector<ScenePoint>;
using Mask = std::vector<std::uint8_t>;

constexpr std::size_t kBlock = ScenePoints::kBlockPoints;
constexpr std::size_t kFew = kBlock / 2;  // that many are no small block

static_assert(std::ranges::forward_range<ScenePoints>);

bool same(const ScenePoint& a, const ScenePoint& b) {
    return a.position == b.position && a.error_px == b.error_px && a.track == b.track;
}

/// Points that can be told from those of any other call with the same generator.
Points some_points(std::size_t count, Rng& rng) {
    Points points(count);
    for (ScenePoint& point : points) {
        point.position = rng.normal3();
        point.error_px = static_cast<float>(rng.uniform(0.0, 3.0));
        const auto first = static_cast<std::uint32_t>(rng.below(100));
        point.track = {{ImageId{first}, 1}, {ImageId{first + 1}, 2}};
    }
    return points;
}

/// One of `per` points is removed, whichever; 0: none, 1: all.
Mask scattered(std::size_t count, std::size_t per, Rng& rng) {
    Mask removed(count, 0);
    for (std::uint8_t& flag : removed) flag = per > 0 && rng.below(per) == 0 ? 1 : 0;
    return removed;
}

Points without(const Points& points, const Mask& removed) {
    Points kept;
    for (std::size_t p = 0; p < points.size(); ++p) {
        if (removed[p] == 0) kept.push_back(points[p]);
    }
    return kept;
}

/// Whichever way they are read.
void expect_equal(const ScenePoints& points, const Points& expected) {
    ASSERT_EQ(points.size(), expected.size());
    EXPECT_EQ(points.empty(), expected.empty());
    EXPECT_TRUE(std::ranges::equal(points, expected, same));
    EXPECT_TRUE(std::ranges::equal(points.to_vector(), expected, same));
    for (std::size_t p = 0; p < expected.size(); ++p) ASSERT_TRUE(same(points[p], expected[p]));
    std::size_t first = 0;
    for (std::size_t b = 0; b < points.blocks().size(); ++b) {
        EXPECT_EQ(points.first_of(b), first);
        EXPECT_FALSE(points.blocks()[b]->points().empty());
        first += points.blocks()[b]->points().size();
    }
    EXPECT_EQ(first, points.size());
}

bool is_small(const PointBlockPtr& block) {
    return block->points().size() < kFew;
}

/// That blocks are shared where they can be, and put together where they cannot.
void expect_sensible_blocks(const ScenePoints& before, const Mask& removed,
                            const ScenePoints& after) {
    std::map<PointBlockPtr, std::ptrdiff_t> whole;  // how often; points may be there twice
    for (std::size_t b = 0; b < before.blocks().size(); ++b) {
        const PointBlockPtr& block = before.blocks()[b];
        const auto flags = std::span(removed).subspan(before.first_of(b), block->points().size());
        whole[block] += std::ranges::count(flags, 0) == std::ssize(flags) ? 1 : 0;
    }
    for (const auto& [block, times] : whole) {
        const auto shared = std::ranges::count(after.blocks(), block);
        EXPECT_LE(shared, times);
        EXPECT_TRUE(is_small(block) || shared == times);
    }
    EXPECT_LE(after.blocks().size(), before.blocks().size());
    for (std::size_t b = 0; b + 1 < after.blocks().size(); ++b) {
        if (!is_small(after.blocks()[b]) || !is_small(after.blocks()[b + 1])) continue;
        EXPECT_TRUE(whole.contains(after.blocks()[b])) << "what was put together could take more";
    }
}

/// Blocks of many sizes.
ScenePoints uneven(std::initializer_list<std::size_t> sizes, Rng& rng) {
    ScenePoints points;
    for (const std::size_t size : sizes)
        points.append(std::make_shared<const PointBlock>(some_points(size, rng)));
    return points;
}

TEST(PointBlock, KnowsWhichImagesSeeItsPoints) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Rng rng(seed);
        Points points(1 + rng.below(500));
        std::set<ImageId> expected;
        for (ScenePoint& point : points) {
            std::set<Observation> track;
            while (track.size() < 2 + rng.below(10)) {
                // Far apart, and alike in their last bits.
                const auto image = static_cast<std::uint32_t>(1024 * rng.below(40) + rng.below(3));
                track.insert({ImageId{image}, 0});
            }
            point.track.assign(track.begin(), track.end());
            for (const Observation& seen : point.track) expected.insert(seen.image);
        }
        const PointBlock block(std::move(points));
        EXPECT_TRUE(std::ranges::equal(block.images(), expected));
    }
    EXPECT_TRUE(PointBlock({}).images().empty());
}

TEST(PointBlock, KnowsImagesOfWhateverNumber) {
    constexpr std::uint32_t kMost = 0xffffffff;
    ScenePoint point;
    point.track = {{ImageId{0}, 1}, {ImageId{1023}, 1}, {ImageId{1024}, 1}, {ImageId{kMost}, 1}};
    ScenePoint other;
    other.track = {{ImageId{1024}, 2}, {ImageId{2048}, 2}};
    const PointBlock block({point, other, point});
    const std::vector<ImageId> expected{ImageId{0}, ImageId{1023}, ImageId{1024}, ImageId{2048},
                                        ImageId{kMost}};
    EXPECT_TRUE(std::ranges::equal(block.images(), expected));
}

TEST(PointBlock, SumsErrors) {
    Rng rng(1);
    const Points points = some_points(kBlock, rng);
    double sum = 0.0;
    for (const ScenePoint& point : points) sum += point.error_px;
    const PointBlock block(points);
    EXPECT_DOUBLE_EQ(block.sum_error_px(), sum);
    EXPECT_EQ(PointBlock({}).sum_error_px(), 0.0);
    EXPECT_TRUE(std::ranges::equal(block.points(), points, same));
}

TEST(ScenePoints, AreCutIntoBlocks) {
    Rng rng(2);
    expect_equal({}, {});
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, kBlock - 1, kBlock, kBlock + 1, 4 * kBlock, 5000UL}) {
        SCOPED_TRACE(count);
        const Points points = some_points(count, rng);
        const ScenePoints cut(points);
        expect_equal(cut, points);
        ASSERT_EQ(cut.blocks().size(), (count + kBlock - 1) / kBlock);
        for (std::size_t b = 0; b + 1 < cut.blocks().size(); ++b)
            EXPECT_EQ(cut.blocks()[b]->points().size(), kBlock);
    }
}

TEST(ScenePoints, AreReadInOrder) {
    Rng rng(3);
    const ScenePoints points = uneven({1, 700, 2}, rng);
    ScenePoints::Iterator at = points.begin();
    EXPECT_EQ(&*at++, &points[0]);
    EXPECT_EQ(&*at, &points[1]);
    EXPECT_EQ(at->track.data(), points[1].track.data());
    EXPECT_EQ(std::ranges::distance(points), 703);
    EXPECT_EQ(ScenePoints().begin(), ScenePoints().end());
}

TEST(ScenePoints, AfterSomeShareTheBlocksBehindThem) {
    Rng rng(4);
    const ScenePoints points = uneven({kBlock, 3, 1, 1500, kFew}, rng);
    const Points all = points.to_vector();
    std::set<std::size_t> counts{0, 1, all.size() - 1, all.size()};
    for (std::size_t b = 1; b < points.blocks().size(); ++b) {
        for (const std::size_t near : {0U, 1U, 2U}) counts.insert(points.first_of(b) + near - 1);
    }
    for (const std::size_t count : counts) {
        SCOPED_TRACE(count);
        const ScenePoints rest = points.after(count);
        expect_equal(rest, {all.begin() + static_cast<std::ptrdiff_t>(count), all.end()});
        std::size_t whole = 0;
        for (std::size_t b = 0; b < points.blocks().size(); ++b)
            whole += points.first_of(b) >= count ? 1U : 0U;
        EXPECT_TRUE(std::ranges::equal(points.blocks().last(whole), rest.blocks().last(whole)));
        EXPECT_LE(rest.blocks().size(), whole + 2) << "of one that is cut, up to twice as large";
    }
    EXPECT_TRUE(ScenePoints().after(0).empty());
}

TEST(ScenePoints, WithoutSomeShareTheBlocksThatKeepAll) {
    Rng rng(5);
    const ScenePoints points(some_points(5 * kBlock, rng));
    Mask removed(points.size(), 0);
    EXPECT_TRUE(std::ranges::equal(points.without(removed).blocks(), points.blocks()));
    removed[2 * kBlock] = removed[3 * kBlock - 1] = 1;
    const ScenePoints left = points.without(removed);
    expect_equal(left, without(points.to_vector(), removed));
    ASSERT_EQ(left.blocks().size(), 5U);
    for (std::size_t b = 0; b < 5; ++b)
        EXPECT_EQ(left.blocks()[b] == points.blocks()[b], b != 2) << b;
    std::ranges::fill(removed, std::uint8_t{1});
    expect_equal(points.without(removed), {});
    expect_equal(ScenePoints().without({}), {});
}

TEST(ScenePoints, AppendedOnesShareTheirBlocks) {
    Rng rng(6);
    ScenePoints points = uneven({5, kBlock}, rng);
    const ScenePoints others = uneven({700, 1}, rng);
    Points expected = points.to_vector();
    std::ranges::copy(others.to_vector(), std::back_inserter(expected));
    std::vector<PointBlockPtr> blocks(points.blocks().begin(), points.blocks().end());
    blocks.insert(blocks.end(), others.blocks().begin(), others.blocks().end());
    points.append(others);
    expect_equal(points, expected);
    EXPECT_TRUE(std::ranges::equal(points.blocks(), blocks));
    points.append(ScenePoints());
    points.append(Points());
    points.append(std::make_shared<const PointBlock>(Points()));
    EXPECT_TRUE(std::ranges::equal(points.blocks(), blocks)) << "nothing came to them";
    points.append(points);
    const Points once = expected;
    expected.insert(expected.end(), once.begin(), once.end());
    expect_equal(points, expected);
    EXPECT_EQ(points.blocks()[0], points.blocks()[4]);
}

TEST(ScenePoints, CopiesShareBlocksAndAreIndependent) {
    Rng rng(7);
    const Points all = some_points(3 * kBlock, rng);
    ScenePoints points(all);
    ScenePoints copy = points;
    EXPECT_TRUE(std::ranges::equal(copy.blocks(), points.blocks()));
    points.append(some_points(10, rng));
    expect_equal(copy, all);
    points = copy;
    copy = copy.without(scattered(copy.size(), 2, rng));
    copy.append(copy);
    expect_equal(points, all);
    // A list that is taken out is nobody else's.
    Points changed = points.to_vector();
    changed[0].track.clear();
    expect_equal(points, all);
    copy = {};
    expect_equal(copy, {});
    expect_equal(points, all);
}

/// Beside a trivially correct model: several values that are made of one another.
TEST(ScenePoints, EqualAListWhateverIsDoneToThem) {
    constexpr std::array kSizes{std::size_t{0}, std::size_t{1}, kBlock - 1,
                                kBlock,         kBlock + 1,     3 * kBlock + 7};
    constexpr std::array<std::size_t, 6> kPer{0, 1, 2, 20, 500, 5000};
    struct Value {
        ScenePoints points;
        Points expected;
    };
    Rng rng(8);
    std::array<Value, 4> values;
    for (int step = 0; step < 400; ++step) {
        SCOPED_TRACE(step);
        Value& value = values[rng.below(values.size())];
        const Value other = values[rng.below(values.size())];  // at times the same
        switch (value.points.size() > 6 * kBlock ? 0 : rng.below(6)) {
            case 0: {
                value.expected = some_points(kSizes[rng.below(kSizes.size())], rng);
                value.points = value.expected;
                break;
            }
            case 1:
            case 2: {
                const Mask removed =
                    scattered(value.points.size(), kPer[rng.below(kPer.size())], rng);
                const ScenePoints before =
                    std::exchange(value.points, value.points.without(removed));
                expect_sensible_blocks(before, removed, value.points);
                value.expected = without(value.expected, removed);
                break;
            }
            case 3: {
                value.points.append(other.points);
                std::ranges::copy(other.expected, std::back_inserter(value.expected));
                break;
            }
            case 4: {
                const Points few = some_points(rng.below(50), rng);
                value.points.append(few);
                std::ranges::copy(few, std::back_inserter(value.expected));
                break;
            }
            case 5: {
                const std::size_t count = rng.below(other.points.size() + 1);
                value.points = other.points.after(count);
                value.expected = {other.expected.begin() + static_cast<std::ptrdiff_t>(count),
                                  other.expected.end()};
                break;
            }
        }
        expect_equal(value.points, value.expected);
        if (HasFatalFailure()) return;
    }
    for (const Value& value : values) expect_equal(value.points, value.expected);
}

/// As a model does that grows: what new images see is replaced wherever it is, and comes last.
TEST(ScenePoints, ThatChangeHereAndThereStayInFewBlocks) {
    for (const std::size_t per : {4U, 20U, 100U}) {
        SCOPED_TRACE(per);
        Rng rng(per);
        Points expected = some_points(6 * kBlock, rng);
        ScenePoints points(expected);
        for (int round = 0; round < 200; ++round) {
            const Mask removed = scattered(points.size(), per, rng);
            const ScenePoints left = points.without(removed);
            expect_sensible_blocks(points, removed, left);
            expected = without(expected, removed);
            const Points added = some_points(points.size() - left.size(), rng);
            points = left;
            points.append(added);
            std::ranges::copy(added, std::back_inserter(expected));
            ASSERT_LE(points.blocks().size(), 2 + 4 * points.size() / kBlock) << round;
        }
        expect_equal(points, expected);
    }
}

/// Blocks that are far too small are put together as soon as something changes in each of them.
TEST(ScenePoints, ThatChangeEverywhereAreInLargeBlocks) {
    for (const std::size_t per : {0U, 20U, 200U}) {
        SCOPED_TRACE(per);
        Rng rng(10 + per);
        Points expected = some_points(6 * kBlock, rng);
        ScenePoints points(expected);
        for (int round = 0; round < 300; ++round) {
            Mask removed = scattered(points.size(), per, rng);
            for (std::size_t b = 0; b < points.blocks().size(); ++b)
                removed[points.first_of(b) + rng.below(points.blocks()[b]->points().size())] = 1;
            const ScenePoints left = points.without(removed);
            expect_sensible_blocks(points, removed, left);
            ASSERT_LE(left.blocks().size(), 1 + left.size() / kFew) << round;
            expected = without(expected, removed);
            points = left;
            for (std::size_t images = rng.below(10); images > 0; --images) {
                const Points added = some_points(1 + rng.below(5), rng);
                points.append(added);
                std::ranges::copy(added, std::back_inserter(expected));
            }
        }
        expect_equal(points, expected);
    }
}

TEST(ScenePoints, OfWhichFewAreLeftArePutTogether) {
    Rng rng(9);
    const ScenePoints points(some_points(20 * kBlock, rng));
    Mask removed(points.size(), 1);
    for (std::size_t p = 0; p < removed.size(); p += 100) removed[p] = 0;
    const ScenePoints left = points.without(removed);
    expect_equal(left, without(points.to_vector(), removed));
    EXPECT_EQ(left.size(), 205U);
    EXPECT_EQ(left.blocks().size(), 1U);
    // Between blocks that nobody touches, they stay where they are.
    std::fill_n(removed.begin() + 10 * kBlock, kBlock, std::uint8_t{0});
    const ScenePoints around = points.without(removed);
    expect_equal(around, without(points.to_vector(), removed));
    ASSERT_EQ(around.blocks().size(), 3U);
    EXPECT_EQ(around.blocks()[1], points.blocks()[10]);
}

}  // namespace
}  // namespace psfm
