// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/vocabulary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "stages/retrieval/train_vocabulary.h"
#include "tests/stages/retrieval/planted_descriptors.h"

namespace psfm {
namespace {

using synthetic::random_points;
using synthetic::view_of;

std::size_t nearest(const std::uint8_t* row, const Descriptors& others) {
    std::size_t best = 0;
    long best_distance = -1;
    for (std::size_t j = 0; j < others.rows(); ++j) {
        long distance = 0;
        for (std::size_t k = 0; k < Descriptors::kSize; ++k) {
            const long d = row[k] - others.row(j)[k];
            distance += d * d;
        }
        if (best_distance < 0 || distance < best_distance) {
            best = j;
            best_distance = distance;
        }
    }
    return best;
}

TEST(Vocabulary, AssignsTheNearestWordOfTheNearestCell) {
    const Descriptors sample = random_points(2000, 1);
    const WordTree tree = train_vocabulary(sample, {.words = 150, .iterations = 3});
    const Vocabulary vocabulary(tree);
    ASSERT_EQ(vocabulary.word_count(), tree.word_count());
    const Descriptors rows = random_points(500, 2);
    const auto words = vocabulary.assign(rows.values);
    ASSERT_EQ(words.size(), 500U);
    for (std::size_t i = 0; i < rows.rows(); ++i) {
        const std::size_t cell = nearest(rows.row(i), tree.cells);
        std::size_t word = nearest(rows.row(i), tree.words[cell]);
        for (std::size_t c = 0; c < cell; ++c) word += tree.words[c].rows();
        ASSERT_EQ(words[i], word) << i;
    }
    EXPECT_THAT(vocabulary.assign({}), testing::IsEmpty());
}

TEST(Vocabulary, ViewsOfAPointShareItsWord) {
    const Descriptors points = random_points(300, 3);
    Descriptors sample;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Descriptors view = view_of(points, 0, 300, 6, seed);
        sample.values.insert(sample.values.end(), view.values.begin(), view.values.end());
    }
    const Vocabulary vocabulary(train_vocabulary(sample, {.words = 300, .iterations = 8}));
    const auto words = vocabulary.assign(view_of(points, 0, 300, 6, 100).values);
    const auto again = vocabulary.assign(view_of(points, 0, 300, 6, 200).values);
    std::size_t equal = 0;
    for (std::size_t i = 0; i < words.size(); ++i) equal += words[i] == again[i] ? 1 : 0;
    EXPECT_GT(equal, 270U);
    EXPECT_GT(std::set(words.begin(), words.end()).size(), 150U);
}

TEST(TrainVocabulary, NumberOfWordsIsNearWhatWasAskedFor) {
    const Descriptors sample = random_points(5000, 5);
    const WordTree tree = train_vocabulary(sample, {.words = 1000, .iterations = 2});
    EXPECT_NEAR(static_cast<double>(tree.word_count()), 1000.0, 50.0);
    EXPECT_NEAR(static_cast<double>(tree.cells.rows()), 32.0, 3.0);
    for (const Descriptors& words : tree.words) EXPECT_GE(words.rows(), 1U);
    EXPECT_EQ(train_vocabulary(sample, {.words = 1000, .iterations = 2}), tree);
}

TEST(TrainVocabulary, FewOrEqualDescriptorsGiveFewWords) {
    EXPECT_EQ(train_vocabulary({}, {}).word_count(), 0U);
    EXPECT_EQ(train_vocabulary(random_points(1, 1), {}).word_count(), 1U);
    Descriptors equal;
    equal.values.assign(50 * Descriptors::kSize, 7);
    EXPECT_EQ(train_vocabulary(equal, {}).word_count(), 1U);
}

TEST(Vocabulary, HashTellsVocabulariesApart) {
    const WordTree tree = train_vocabulary(random_points(200, 6), {.words = 20, .iterations = 2});
    WordTree changed = tree;
    ++changed.words.back().values.back();
    EXPECT_EQ(Vocabulary(tree), Vocabulary(tree));
    EXPECT_FALSE(Vocabulary(tree) == Vocabulary(changed));
}

}  // namespace
}  // namespace psfm
