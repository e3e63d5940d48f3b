// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/inverted_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

using synthetic::Rng;
using Words = std::vector<std::uint32_t>;

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

Words random_words(Rng& rng, std::size_t count, std::size_t word_count) {
    Words words(count);
    for (std::uint32_t& word : words) {
        word = static_cast<std::uint32_t>(std::min(rng.below(word_count), rng.below(word_count)));
    }
    return words;
}

/// tf-idf vector over all words, as the header defines it.
std::vector<double> vector_of(const Words& words, const std::vector<double>& idf) {
    std::vector<double> out(idf.size());
    for (const std::uint32_t word : words) out[word] += 1.0;
    for (std::size_t w = 0; w < out.size(); ++w) out[w] = std::sqrt(out[w]) * idf[w];
    return out;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

TEST(InvertedFile, ScoresAreCosinesOfTfIdfVectors) {
    constexpr std::size_t kWords = 60;
    Rng rng(1);
    InvertedFile index(kWords);
    std::vector<Words> images;
    for (int i = 0; i < 25; ++i) {
        images.push_back(random_words(rng, 30, kWords));
        index.add(images.back());
    }
    index.refresh_weights();
    std::vector<double> idf(kWords);
    for (std::uint32_t w = 0; w < kWords; ++w) {
        double seen = 0.0;
        for (const Words& image : images)
            seen += std::count(image.begin(), image.end(), w) > 0 ? 1.0 : 0.0;
        idf[w] = std::log(25.0 / std::max(seen, 1.0));
    }
    images.push_back(random_words(rng, 30, kWords));  // weighed as of the last refresh
    index.add(images.back());

    const Words query = random_words(rng, 40, kWords);
    const auto found = index.most_similar(query, 100, kAll);
    const auto q = vector_of(query, idf);
    ASSERT_FALSE(found.empty());
    for (std::size_t i = 0; i < found.size(); ++i) {
        const auto d = vector_of(images[found[i].image], idf);
        EXPECT_NEAR(found[i].score, dot(q, d) / std::sqrt(dot(d, d)), 1e-4);
        EXPECT_GE(found[i > 0 ? i - 1 : 0].score, found[i].score);
    }
    std::size_t expected = 0;
    for (const Words& image : images) expected += dot(q, vector_of(image, idf)) > 0.0 ? 1 : 0;
    EXPECT_EQ(found.size(), expected);
}

TEST(InvertedFile, AnImageIsMostSimilarToItself) {
    Rng rng(2);
    InvertedFile index(500);
    std::vector<Words> images;
    for (int i = 0; i < 40; ++i) {
        images.push_back(random_words(rng, 100, 500));
        index.add(images.back());
    }
    index.refresh_weights();
    for (std::uint32_t i = 0; i < 40; ++i) {
        const auto found = index.most_similar(images[i], 1, kAll);
        ASSERT_EQ(found.size(), 1U);
        EXPECT_EQ(found[0].image, i);
    }
}

TEST(InvertedFile, EqualScoresComeInTheOrderOfTheImages) {
    InvertedFile index(4);
    index.add(Words{3});
    for (int i = 0; i < 5; ++i) index.add(Words{1, 2});
    index.refresh_weights();
    const auto found = index.most_similar(Words{1}, 3, kAll);
    ASSERT_EQ(found.size(), 3U);
    for (std::uint32_t i = 0; i < 3; ++i) EXPECT_EQ(found[i].image, i + 1);
}

TEST(InvertedFile, WordsSeenEverywhereCountForNothing) {
    InvertedFile index(3);
    for (int i = 0; i < 3; ++i) index.add(Words{0});
    index.add(Words{0, 1});
    index.refresh_weights();
    EXPECT_THAT(index.most_similar(Words{0}, 10, kAll), testing::IsEmpty());
    const auto found = index.most_similar(Words{0, 1, 2}, 10, kAll);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].image, 3U);
}

TEST(InvertedFile, NothingIsFoundWithoutWordsImagesOrWeights) {
    InvertedFile index(5);
    EXPECT_THAT(index.most_similar(Words{1}, 10, kAll), testing::IsEmpty());
    index.add(Words{1});
    index.add(Words{});
    EXPECT_THAT(index.most_similar(Words{1}, 10, kAll), testing::IsEmpty());  // no weights yet
    index.refresh_weights();
    EXPECT_THAT(index.most_similar(Words{}, 10, kAll), testing::IsEmpty());
    EXPECT_EQ(index.most_similar(Words{1}, 10, kAll).size(), 1U);
    EXPECT_THAT(index.most_similar(Words{1}, 0, kAll), testing::IsEmpty());
    EXPECT_EQ(index.image_count(), 2U);
}

TEST(InvertedFile, RarestWordsAreReadFirstWhenReadingIsLimited) {
    InvertedFile index(3);
    for (int i = 0; i < 9; ++i) index.add(Words{0});
    index.add(Words{1});
    index.refresh_weights();
    const auto found = index.most_similar(Words{0, 1}, 100, 5);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].image, 9U);
    EXPECT_EQ(index.most_similar(Words{0, 1}, 100, 10).size(), 10U);
    EXPECT_EQ(index.most_similar(Words{0}, 100, 5).size(), 9U);  // the first word is always read
}

TEST(InvertedFile, TellsHowMuchItKeeps) {
    InvertedFile file(1000);
    EXPECT_EQ(file.bytes(), 0U);
    std::vector<std::uint32_t> words(100);
    std::iota(words.begin(), words.end(), 0U);
    for (std::uint32_t image = 0; image < 16; ++image) file.add(words);
    EXPECT_GE(file.bytes(), 16U * 100U * 4U);
    EXPECT_LE(file.bytes(), 2U * 16U * (100U * 4U + 4U));
}

TEST(InvertedFile, RepetitionsOfAWordAreDampedAndBounded) {
    InvertedFile index(3);
    index.add(Words(1000, 1));  // beyond what a posting can count
    index.add(Words{1, 2});
    index.add(Words{0});
    index.refresh_weights();
    const auto found = index.most_similar(Words{2, 1}, 10, kAll);
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].image, 1U);
}

}  // namespace
}  // namespace psfm
