// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/run_retrieval.h"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "stages/retrieval/expand_candidates.h"
#include "stages/retrieval/session_vocabulary.h"

namespace psfm {
namespace {

std::span<const std::uint8_t> indexed_rows(const Descriptors& descriptors,
                                           const RetrievalOptions& options) {
    const std::size_t rows = std::min(descriptors.rows(), options.features_per_image);
    return std::span(descriptors.values).first(rows * Descriptors::kSize);
}

/// Images present when the weights are refreshed, and a vocabulary trained if one may be: the
/// number of candidates times a power of two.
bool is_milestone(std::size_t images, const RetrievalOptions& options) {
    if (images == 0 || images % options.candidates != 0) return false;
    const std::size_t times = images / options.candidates;
    return (times & (times - 1)) == 0;
}

/// Which vocabulary is used from here on.
enum class NewWords : std::uint8_t { kNone, kTrained, kIndependent };

NewWords new_words(std::size_t images, const RetrievalState& state,
                   const RetrievalOptions& options) {
    if (state.given || !is_milestone(images, options)) return NewWords::kNone;
    if (images == options.candidates || images <= options.max_training_images)
        return NewWords::kTrained;
    return state.independent ? NewWords::kIndependent : NewWords::kNone;
}

/// Adds images [begin, end) to the index, and refreshes its weights where a milestone is passed.
Result<void> index_images(InvertedFile& index, const Vocabulary& vocabulary, std::uint32_t begin,
                          std::uint32_t end, std::uint32_t first_refresh,
                          const DescriptorSource& source, const RetrievalOptions& options) {
    for (std::uint32_t i = begin; i < end; ++i) {
        if (i >= first_refresh && is_milestone(i, options)) index.refresh_weights();
        const auto descriptors = source(ImageId{i});
        if (!descriptors.ok()) return descriptors.error();
        index.add(vocabulary.assign(indexed_rows(**descriptors, options)));
    }
    return {};
}

struct Indexed {
    std::shared_ptr<const Vocabulary> vocabulary;
    InvertedFile index;
};

/// Indexes images [0, image_count) by another vocabulary, as of the milestone `since`.
Result<Indexed> index_anew(std::shared_ptr<const Vocabulary> vocabulary, std::uint32_t since,
                           std::uint32_t image_count, const DescriptorSource& source,
                           const RetrievalOptions& options) {
    InvertedFile index(vocabulary->word_count());
    const auto done = index_images(index, *vocabulary, 0, image_count, since, source, options);
    if (!done.ok()) return done.error();
    return Indexed{std::move(vocabulary), std::move(index)};
}

/// Trains from images [0, training_images) and indexes images [0, image_count).
Result<Indexed> train(std::uint32_t training_images, std::uint32_t image_count,
                      const DescriptorSource& source, const RetrievalOptions& options) {
    const auto tree = train_session_vocabulary(training_images, source, options);
    if (!tree.ok()) return tree.error();
    return index_anew(std::make_shared<const Vocabulary>(*tree), training_images, image_count,
                      source, options);
}

/// The independent vocabulary from the milestone `since` on.
Result<void> take_over(RetrievalState& state, std::uint32_t since, std::uint32_t image_count,
                       const DescriptorSource& source, const RetrievalOptions& options) {
    auto vocabulary = state.independent();
    if (!vocabulary.ok()) return vocabulary.error();
    auto indexed = index_anew(*std::move(vocabulary), since, image_count, source, options);
    if (!indexed.ok()) return indexed.error();
    state.independent = {};
    state.given = state.vocabulary = std::move(indexed->vocabulary);
    state.index = std::move(indexed->index);
    return {};
}

std::vector<RetrievalCandidate> all_earlier(std::uint32_t count) {
    std::vector<RetrievalCandidate> all;
    all.reserve(count);
    for (std::uint32_t i = 0; i < count; ++i) all.push_back({ImageId{i}, 0.F});
    return all;
}

std::vector<RetrievalCandidate> most_similar(const InvertedFile& index,
                                             std::span<const std::uint32_t> words,
                                             const RetrievalOptions& options,
                                             const ViewGraph& view_graph) {
    std::vector<RetrievalCandidate> candidates;
    for (const ScoredImage& found :
         expand_candidates(index.most_similar(words, options.candidates, options.max_postings),
                           view_graph, options)) {
        candidates.push_back({ImageId{found.image}, found.score});
    }
    std::sort(candidates.begin(), candidates.end(),
              [](const auto& a, const auto& b) { return a.image < b.image; });
    return candidates;
}

}  // namespace

Result<RetrievalResult> run_retrieval(RetrievalState& state, ImageId image,
                                      const Descriptors& descriptors,
                                      const DescriptorSource& source,
                                      const RetrievalOptions& options,
                                      const ViewGraph& view_graph) {
    if (const auto valid = validate(options); !valid.ok()) return valid.error();
    const std::uint32_t earlier = state.image_count;
    if (index_of(image) != earlier) {
        return Error{ErrorCode::kInvalidArgument,
                     "retrieval: image " + std::to_string(index_of(image)) +
                         " arrived where image " + std::to_string(earlier) +
                         " was due; images must come in the order of their ids"};
    }
    RetrievalResult result;
    const NewWords due = new_words(earlier, state, options);
    if (due == NewWords::kIndependent) {
        const auto taken = take_over(state, earlier, earlier, source, options);
        if (!taken.ok()) return taken.error();
        result.new_words = state.vocabulary->word_count();
    } else if (due == NewWords::kTrained) {
        auto trained = train(earlier, earlier, source, options);
        if (!trained.ok()) return trained.error();
        result.new_words = trained->vocabulary->word_count();
        state.vocabulary = std::move(trained->vocabulary);
        state.index = std::move(trained->index);
    }
    if (state.vocabulary && is_milestone(earlier, options)) state.index.refresh_weights();
    std::vector<std::uint32_t> words;
    if (state.vocabulary) words = state.vocabulary->assign(indexed_rows(descriptors, options));
    result.candidates = earlier <= options.candidates
                            ? all_earlier(earlier)
                            : most_similar(state.index, words, options, view_graph);
    if (state.vocabulary) state.index.add(words);
    ++state.image_count;
    return result;
}

Result<RetrievalState> rebuild_retrieval(std::shared_ptr<const Vocabulary> given,
                                         std::uint32_t image_count, const DescriptorSource& source,
                                         const RetrievalOptions& options,
                                         VocabularySource independent) {
    if (const auto valid = validate(options); !valid.ok()) return valid.error();
    RetrievalState state = make_retrieval_state(std::move(given), std::move(independent));
    if (state.given) {
        const auto indexed =
            index_images(state.index, *state.vocabulary, 0, image_count, 0, source, options);
        if (!indexed.ok()) return indexed.error();
    } else {
        // Words change when the image after the milestone arrives.
        std::uint32_t training_images = 0;
        std::optional<std::uint32_t> taken_over;
        for (std::uint32_t images = 0; images < image_count && !taken_over; ++images) {
            const NewWords due = new_words(images, state, options);
            if (due == NewWords::kIndependent) taken_over = images;
            if (due == NewWords::kTrained) training_images = images;
        }
        if (taken_over) {
            const auto taken = take_over(state, *taken_over, image_count, source, options);
            if (!taken.ok()) return taken.error();
        } else if (training_images > 0) {
            auto trained = train(training_images, image_count, source, options);
            if (!trained.ok()) return trained.error();
            state.vocabulary = std::move(trained->vocabulary);
            state.index = std::move(trained->index);
        }
    }
    state.image_count = image_count;
    return state;
}

}  // namespace psfm
