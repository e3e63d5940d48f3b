// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace psfm {

/// An indexed image and its similarity to a query.
struct ScoredImage {
    std::uint32_t image = 0;
    float score = 0.F;
};

/// For each visual word the images that show it. Similarity of two images: cosine of the angle
/// between their tf-idf vectors (Sivic & Zisserman, ICCV 2003), the term frequency damped by a
/// square root against repeated structure (burstiness: Jegou, Douze & Schmid, CVPR 2009).
/// Invariant: the state depends on the sequence of calls and their arguments only.
/// Not thread-safe while it is changed.
class InvertedFile {
  public:
    explicit InvertedFile(std::size_t word_count = 0);

    /// Adds the next image (numbered from 0). REQUIRES: words below word_count; fewer than 2^24
    /// images.
    void add(std::span<const std::uint32_t> words);

    /// Recomputes the words' weights from the images present, and the images' lengths under them.
    /// Until the first call every weight is zero and nothing is found; later images are weighed as
    /// of the last call. Linear in the postings: call it when the number of images has doubled, and
    /// the cost of all calls stays proportional to the number of images.
    void refresh_weights();

    /// The most similar images, descending by score, then ascending by number; images that share no
    /// weighted word are left out. Words are looked up rarest first, and no more than about
    /// max_postings entries are read: the cost is bounded, whatever the number of images.
    std::vector<ScoredImage> most_similar(std::span<const std::uint32_t> words, std::size_t count,
                                          std::size_t max_postings) const;

    /// Memory that the images take, about. Linear in the words.
    std::size_t bytes() const;
    std::size_t image_count() const { return lengths_.size(); }
    std::size_t word_count() const { return postings_.size(); }
    bool operator==(const InvertedFile&) const = default;

  private:
    struct Posting {
        std::uint32_t image : 24;
        std::uint32_t occurrences : 8;  ///< of the word in the image, at most 255
        bool operator==(const Posting&) const = default;
    };
    struct WordCount {
        std::uint32_t word;
        std::uint32_t occurrences;
    };
    static std::vector<WordCount> count_words(std::span<const std::uint32_t> words);
    float weight(std::uint32_t word, std::uint32_t occurrences) const;

    std::vector<std::vector<Posting>> postings_;  ///< of each word, ascending by image
    std::vector<float> idf_;                      ///< of each word
    std::vector<float> lengths_;  ///< Euclidean length of each image's tf-idf vector
};

}  // namespace psfm
