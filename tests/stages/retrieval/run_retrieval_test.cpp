// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/run_retrieval.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "stages/retrieval/train_vocabulary.h"
#include "tests/stages/retrieval/planted_descriptors.h"

namespace psfm {
namespace {

using synthetic::Ring;

/// Small enough for tests: milestones at 8, 16, 32, … images.
RetrievalOptions small_options() {
    RetrievalOptions options;
    options.candidates = 8;
    options.words_per_image = 40;
    options.training_iterations = 3;
    return options;
}

struct Streamed {
    RetrievalState state;
    std::vector<RetrievalResult> results;
};

Streamed stream(const Ring& ring, std::size_t count, std::shared_ptr<const Vocabulary> given,
                const RetrievalOptions& options) {
    Streamed out{make_retrieval_state(std::move(given)), {}};
    for (std::uint32_t i = 0; i < count; ++i) {
        auto result = run_retrieval(out.state, ImageId{i}, *ring.images[i], ring.source(), options);
        EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
        if (result) out.results.push_back(*std::move(result));
    }
    return out;
}

std::vector<std::uint32_t> candidates_of(const RetrievalResult& result) {
    std::vector<std::uint32_t> out;
    for (const RetrievalCandidate& candidate : result.candidates)
        out.push_back(index_of(candidate.image));
    return out;
}

TEST(RunRetrieval, EveryEarlierImageIsACandidateAtFirst) {
    const Ring ring(12, 60, 20, 1);
    const Streamed streamed = stream(ring, 10, nullptr, small_options());
    for (std::size_t i = 0; i <= 8; ++i) {
        std::vector<std::uint32_t> all(i);
        for (std::size_t j = 0; j < i; ++j) all[j] = static_cast<std::uint32_t>(j);
        EXPECT_EQ(candidates_of(streamed.results[i]), all);
        EXPECT_EQ(streamed.results[i].new_words > 0, i == 8) << i;
    }
    EXPECT_LE(streamed.results[9].candidates.size(), 8U);
}

TEST(RunRetrieval, FindsTheNeighboursOnARing) {
    const Ring ring(60, 80, 20, 2);  // neighbours share 60, 40 and 20 of 80 points
    const Streamed streamed = stream(ring, 60, nullptr, small_options());
    std::size_t truly = 0;
    std::size_t found = 0;
    for (std::size_t i = 9; i < 60; ++i) {
        const auto candidates = candidates_of(streamed.results[i]);
        EXPECT_LE(candidates.size(), 8U);
        EXPECT_TRUE(std::is_sorted(candidates.begin(), candidates.end()));
        for (std::uint32_t j = 0; j < i; ++j) {
            if (ring.distance(i, j) > 3) continue;
            ++truly;
            found += std::count(candidates.begin(), candidates.end(), j) > 0 ? 1 : 0;
        }
    }
    EXPECT_GT(truly, 100U);
    EXPECT_GE(static_cast<double>(found), 0.97 * static_cast<double>(truly));
}

TEST(RunRetrieval, TrainsAtEveryDoublingUpToTheLimit) {
    const Ring ring(40, 40, 20, 3);
    RetrievalOptions options = small_options();
    options.max_training_images = 16;
    const Streamed streamed = stream(ring, 40, nullptr, options);
    for (std::size_t i = 0; i < 40; ++i) {
        EXPECT_EQ(streamed.results[i].new_words > 0, i == 8 || i == 16) << i;
    }
}

TEST(RunRetrieval, GivenVocabularyIsUsedAndNeverReplaced) {
    const Ring ring(40, 80, 20, 4);
    const auto given = std::make_shared<const Vocabulary>(
        train_vocabulary(synthetic::random_points(3000, 99), {.words = 1000, .iterations = 3}));
    const Streamed streamed = stream(ring, 40, given, small_options());
    for (const RetrievalResult& result : streamed.results) EXPECT_EQ(result.new_words, 0U);
    EXPECT_EQ(streamed.state.vocabulary, given);
    EXPECT_EQ(streamed.state.index.image_count(), 40U);
    EXPECT_EQ(streamed.results[8].candidates.size(), 8U);  // all of them, still
    std::size_t nearest_found = 0;
    std::size_t nearest = 0;
    for (std::size_t i = 9; i < 40; ++i) {
        const auto candidates = candidates_of(streamed.results[i]);
        for (std::uint32_t j = 0; j < i; ++j) {
            if (ring.distance(i, j) != 1) continue;
            ++nearest;
            nearest_found += std::count(candidates.begin(), candidates.end(), j) > 0 ? 1 : 0;
        }
    }
    EXPECT_GE(static_cast<double>(nearest_found), 0.9 * static_cast<double>(nearest));
}

std::shared_ptr<const Vocabulary> independent_words() {
    return std::make_shared<const Vocabulary>(
        train_vocabulary(synthetic::random_points(3000, 99), {.words = 1000, .iterations = 3}));
}

TEST(RunRetrieval, AnIndependentVocabularyTakesOverAtTheNextDoubling) {
    const Ring ring(40, 80, 20, 4);
    RetrievalOptions options = small_options();
    options.max_training_images = 12;
    const auto words = independent_words();
    int reads = 0;
    RetrievalState state = make_retrieval_state(nullptr, [&] {
        ++reads;
        return words;
    });
    for (std::uint32_t i = 0; i < 40; ++i) {
        const auto result =
            run_retrieval(state, ImageId{i}, *ring.images[i], ring.source(), options);
        ASSERT_TRUE(result.ok());
        EXPECT_EQ(result->new_words > 0, i == 8 || i == 16) << i;
        EXPECT_EQ(reads, i < 16 ? 0 : 1) << i;
        EXPECT_EQ(state.vocabulary == words, i >= 16) << i;
    }
    EXPECT_EQ(state.index.image_count(), 40U);
}

TEST(RunRetrieval, AnIndependentVocabularyThatCannotBeReadIsAnError) {
    const Ring ring(17, 40, 20, 4);
    RetrievalOptions options = small_options();
    options.max_training_images = 12;
    RetrievalState state =
        make_retrieval_state(nullptr, []() -> Result<std::shared_ptr<const Vocabulary>> {
            return Error{ErrorCode::kDamaged, "words"};
        });
    for (std::uint32_t i = 0; i < 16; ++i)
        ASSERT_TRUE(run_retrieval(state, ImageId{i}, *ring.images[i], ring.source(), options).ok());
    const auto before = rebuild_retrieval(nullptr, 16, ring.source(), options);
    ASSERT_TRUE(before.ok());
    const auto failed = run_retrieval(state, ImageId{16}, *ring.images[16], ring.source(), options);
    ASSERT_FALSE(failed.ok());
    EXPECT_EQ(failed.error().code, ErrorCode::kDamaged);
    EXPECT_TRUE(state == *before);
}

TEST(RebuildRetrieval, KnowsTheIndependentVocabulary) {
    const Ring ring(40, 40, 15, 5);
    RetrievalOptions options = small_options();
    options.max_training_images = 12;
    const auto words = independent_words();
    const VocabularySource source = [&] { return words; };
    RetrievalState state = make_retrieval_state(nullptr, source);
    for (std::uint32_t count = 0; count <= 40; ++count) {
        const auto rebuilt = rebuild_retrieval(nullptr, count, ring.source(), options, source);
        ASSERT_TRUE(rebuilt.ok());
        ASSERT_TRUE(*rebuilt == state) << count << " images";
        if (count == 40) break;
        ASSERT_TRUE(
            run_retrieval(state, ImageId{count}, *ring.images[count], ring.source(), options).ok());
    }
}

TEST(RebuildRetrieval, EndsInTheStreamedStateAfterAnyNumberOfImages) {
    const Ring ring(40, 40, 15, 5);
    RetrievalOptions options = small_options();
    options.max_training_images = 16;  // so that 32 is a milestone without training
    const auto given = std::make_shared<const Vocabulary>(
        train_vocabulary(synthetic::random_points(300, 99), {.words = 100, .iterations = 2}));
    for (const auto& vocabulary : {std::shared_ptr<const Vocabulary>(), given}) {
        Streamed streamed{make_retrieval_state(vocabulary), {}};
        for (std::uint32_t count = 0; count <= 40; ++count) {
            const auto rebuilt = rebuild_retrieval(vocabulary, count, ring.source(), options);
            ASSERT_TRUE(rebuilt.ok());
            ASSERT_TRUE(*rebuilt == streamed.state)
                << count << " images, given: " << (vocabulary != nullptr);
            if (count == 40) break;
            ASSERT_TRUE(run_retrieval(streamed.state, ImageId{count}, *ring.images[count],
                                      ring.source(), options)
                            .ok());
            EXPECT_FALSE(*rebuilt == streamed.state);  // the comparison can tell
        }
    }
}

TEST(RunRetrieval, SameCandidatesOnOneAndTwoThreads) {
    const Ring ring(40, 40, 15, 6);
    const Streamed two = stream(ring, 40, nullptr, small_options());
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    const Streamed one = stream(ring, 40, nullptr, small_options());
    EXPECT_TRUE(one.state == two.state);
    for (std::size_t i = 0; i < 40; ++i)
        EXPECT_EQ(one.results[i].candidates, two.results[i].candidates);
}

TEST(RunRetrieval, FailingSourceLeavesTheStateAsItWas) {
    const Ring ring(10, 40, 15, 7);
    Streamed streamed = stream(ring, 8, nullptr, small_options());
    const RetrievalState before = streamed.state;
    const DescriptorSource failing = [&](ImageId id) -> Result<std::shared_ptr<const Descriptors>> {
        if (index_of(id) == 5) return Error{ErrorCode::kDamaged, "record 5 is damaged"};
        return ring.images[index_of(id)];
    };
    const auto result =
        run_retrieval(streamed.state, ImageId{8}, *ring.images[8], failing, small_options());
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::kDamaged);
    EXPECT_TRUE(streamed.state == before);
    EXPECT_TRUE(
        run_retrieval(streamed.state, ImageId{8}, *ring.images[8], ring.source(), small_options())
            .ok());
    EXPECT_FALSE(rebuild_retrieval(nullptr, 10, failing, small_options()).ok());
}

TEST(RunRetrieval, ImagesOutOfOrderAndBadOptionsAreRefused) {
    const Ring ring(3, 10, 5, 8);
    RetrievalState state = make_retrieval_state(nullptr);
    const auto late =
        run_retrieval(state, ImageId{1}, *ring.images[1], ring.source(), small_options());
    ASSERT_FALSE(late.ok());
    EXPECT_EQ(late.error().code, ErrorCode::kInvalidArgument);
    RetrievalOptions bad = small_options();
    bad.candidates = 0;
    const auto refused = run_retrieval(state, ImageId{0}, *ring.images[0], ring.source(), bad);
    ASSERT_FALSE(refused.ok());
    EXPECT_THAT(refused.error().message, testing::HasSubstr("candidates"));
    EXPECT_EQ(state.image_count, 0U);
}

TEST(RunRetrieval, ImagesWithoutFeaturesAreHarmless) {
    Ring ring(20, 30, 10, 9);
    for (const std::size_t blank : {0, 3, 8, 12})
        ring.images[blank] = std::make_shared<const Descriptors>();
    const Streamed streamed = stream(ring, 20, nullptr, small_options());
    EXPECT_TRUE(streamed.results[12].candidates.empty());
    EXPECT_FALSE(streamed.results[13].candidates.empty());
    for (auto& image : ring.images) image = std::make_shared<const Descriptors>();
    EXPECT_TRUE(stream(ring, 20, nullptr, small_options()).results[19].candidates.empty());
}

}  // namespace
}  // namespace psfm
