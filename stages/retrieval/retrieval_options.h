// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "graph/result.h"

namespace psfm {

/// Measurements behind "ours": docs/retrieval.md.
struct RetrievalOptions {
    /// Candidates an image, and the number of earlier images up to which every one is a candidate.
    /// More: time of matching grows in proportion; fewer: overlapping images are never matched.
    /// Paper, section "Progressive Viewgraph": 100.
    std::size_t candidates = 100;
    /// Part of the candidates that are there because the most similar images have edges with them,
    /// in a collection that outgrows similarity. Raised: fewer are asked that nobody knows, so that
    /// places which have not met yet meet later; lowered: in a large collection more of what
    /// overlaps is missed. 0: by similarity alone, as the paper. Ours ("Many images").
    double vouched_part = 0.5;
    /// Images for each candidate up to which similarity finds what overlaps; with more of them the
    /// part above is approached. Raised: as above, lowered; lowered: where a few hundred
    /// photographs of streams resemble each other, those of other streams are asked too late
    /// (quad-streams). Ours ("Many images").
    double vouched_beyond = 10.0;
    /// Features of an image that are indexed and looked up, largest scale first. More: memory and
    /// time grow in proportion, at 4 bytes a feature; fewer: weakly overlapping images are missed.
    /// Ours ("Recall").
    std::size_t features_per_image = 4096;
    /// Words of a vocabulary trained from the session, for each image present. Fewer: long posting
    /// lists, slower queries, less distinctive words; more: descriptors of one point fall apart.
    /// Ours ("Recall").
    std::size_t words_per_image = 240;
    /// Upper limit of the words of a trained vocabulary. More: words that rest on too few of the
    /// training_features (below four each recall was seen to fall); fewer: longer posting lists in
    /// collections above 550 images. Ours ("Recall"); the paper's 1M words were trained
    /// independently.
    std::size_t max_words = std::size_t{1} << 17U;
    /// Descriptors that a vocabulary is trained from, spread evenly over the images and their
    /// features. More: training takes longer, at 256 bytes of memory each while it lasts; fewer:
    /// poorer words. Ours: four for each of max_words.
    std::size_t training_features = 500000;
    /// Larger collections are not trained from any more: the last vocabulary stays, or an
    /// independent one takes over where there is one (`psfm vocabulary train`; in the paper from
    /// the beginning). Larger: a pause in proportion at the next doubling, and too few words for
    /// longer; smaller: words that do not know the later scenes. Ours ("The vocabulary").
    std::size_t max_training_images = 3200;
    /// Iterations of k-means at each of the two levels. More: training takes longer. Ours; not
    /// tuned.
    unsigned training_iterations = 8;
    /// Entries of the inverted file read for a query, rarest words first: bounds the time of a
    /// query, whatever the size of the collection. Fewer: recall falls in large collections. Ours
    /// ("Many images").
    std::size_t max_postings = 2000000;
};

/// @errors kInvalidArgument, naming the field and its range
Result<void> validate(const RetrievalOptions& options);

}  // namespace psfm
