// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/inverted_file.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace psfm {
namespace {

constexpr std::uint32_t kMaxOccurrences = 255;  // Format: the largest of a posting's 8 bits

/// Square roots of 0 … 255: term frequencies damped.
const std::array<float, kMaxOccurrences + 1> kDamped = [] {
    std::array<float, kMaxOccurrences + 1> roots{};
    for (std::size_t i = 0; i < roots.size(); ++i) roots[i] = std::sqrt(static_cast<float>(i));
    return roots;
}();

bool more_similar(const ScoredImage& a, const ScoredImage& b) {
    return a.score != b.score ? a.score > b.score : a.image < b.image;
}

}  // namespace

InvertedFile::InvertedFile(std::size_t word_count) : postings_(word_count), idf_(word_count, 0.F) {}

std::vector<InvertedFile::WordCount> InvertedFile::count_words(
    std::span<const std::uint32_t> words) {
    std::vector<std::uint32_t> sorted(words.begin(), words.end());
    std::sort(sorted.begin(), sorted.end());
    std::vector<WordCount> counts;
    for (const std::uint32_t word : sorted) {
        if (counts.empty() || counts.back().word != word) counts.push_back({word, 0});
        if (counts.back().occurrences < kMaxOccurrences) ++counts.back().occurrences;
    }
    return counts;
}

float InvertedFile::weight(std::uint32_t word, std::uint32_t occurrences) const {
    return idf_[word] * kDamped[occurrences];
}

void InvertedFile::add(std::span<const std::uint32_t> words) {
    assert(image_count() < (1U << 24U));
    const auto image = static_cast<std::uint32_t>(image_count());
    double squared_length = 0.0;
    for (const WordCount& count : count_words(words)) {
        Posting posting{};
        posting.image = image & 0xFFFFFFU;
        posting.occurrences = count.occurrences & 0xFFU;
        postings_[count.word].push_back(posting);
        squared_length += std::pow(weight(count.word, count.occurrences), 2);
    }
    lengths_.push_back(static_cast<float>(std::sqrt(squared_length)));
}

std::size_t InvertedFile::bytes() const {
    std::size_t capacity = 0;
    for (const std::vector<Posting>& postings : postings_) capacity += postings.capacity();
    return capacity * sizeof(Posting) + lengths_.capacity() * sizeof(float);
}

void InvertedFile::refresh_weights() {
    const auto images = static_cast<double>(image_count());
    std::vector<double> squared_lengths(image_count());
    for (std::uint32_t word = 0; word < postings_.size(); ++word) {
        // Words not seen yet are as rare as words seen once; words seen everywhere weigh nothing.
        const auto seen = static_cast<double>(std::max<std::size_t>(postings_[word].size(), 1));
        idf_[word] = static_cast<float>(std::log(std::max(images, 1.0) / seen));
        for (const Posting posting : postings_[word]) {
            squared_lengths[posting.image] += std::pow(weight(word, posting.occurrences), 2);
        }
    }
    for (std::size_t i = 0; i < lengths_.size(); ++i) {
        lengths_[i] = static_cast<float>(std::sqrt(squared_lengths[i]));
    }
}

std::vector<ScoredImage> InvertedFile::most_similar(std::span<const std::uint32_t> words,
                                                    std::size_t count,
                                                    std::size_t max_postings) const {
    std::vector<WordCount> query = count_words(words);
    std::stable_sort(query.begin(), query.end(), [&](const WordCount& a, const WordCount& b) {
        return postings_[a.word].size() < postings_[b.word].size();
    });
    std::vector<float> scores(image_count(), 0.F);
    std::size_t read = 0;
    for (const WordCount& of_word : query) {
        const std::vector<Posting>& postings = postings_[of_word.word];
        if (read > 0 && read + postings.size() > max_postings) break;
        read += postings.size();
        const float query_weight = weight(of_word.word, of_word.occurrences) * idf_[of_word.word];
        for (const Posting posting : postings) {
            scores[posting.image] += query_weight * kDamped[posting.occurrences];
        }
    }
    // The query's own length is the same for all and left out.
    std::vector<ScoredImage> found;
    for (std::uint32_t image = 0; image < scores.size(); ++image) {
        if (scores[image] > 0.F) found.push_back({image, scores[image] / lengths_[image]});
    }
    const std::size_t kept = std::min(count, found.size());
    std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(kept), found.end(),
                      more_similar);
    found.resize(kept);
    return found;
}

}  // namespace psfm
