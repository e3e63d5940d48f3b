// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "graph/view_graph.h"
#include "stages/retrieval/retrieval_options.h"
#include "stages/retrieval/retrieval_state.h"

namespace psfm {

/// An earlier image that may show the same things.
struct RetrievalCandidate {
    ImageId image{};
    float score = 0.F;  ///< similarity, comparable within one result; 0 where nothing was compared
    bool operator==(const RetrievalCandidate&) const = default;
};

struct RetrievalResult {
    std::vector<RetrievalCandidate> candidates;  ///< ascending by image; at most options.candidates
    /// Words of the vocabulary that this call trained or took over; 0: the one before stays.
    std::size_t new_words = 0;
};

/// The retrieval stage: earlier images to match `image` with; then `image` is indexed.
///
/// Up to options.candidates earlier images, all of them are candidates. When that many are present,
/// and whenever their number has doubled since, a vocabulary is trained from all images before this
/// one (unless one was given) and they are indexed anew; up to options.max_training_images, after
/// which the vocabulary stays, or until an independent one takes over. Each image is so indexed
/// about twice in all: the cost an image stays constant. Above, candidates are the most similar
/// images by tf-idf (InvertedFile), and others that these have edges with (expand_candidates).
/// @param source  asked for earlier images when a vocabulary is trained
/// @param view_graph  what is known of the earlier images
/// @errors kInvalidArgument: options, or `image` is not number state.image_count; any error of
///         `source` and of state.independent, passed on. After an error the state is as before the
///         call.
/// Deterministic, the same on every processor and number of threads. Uses the caller's TBB arena.
Result<RetrievalResult> run_retrieval(RetrievalState& state, ImageId image,
                                      const Descriptors& descriptors,
                                      const DescriptorSource& source,
                                      const RetrievalOptions& options,
                                      const ViewGraph& view_graph = {});

/// The state after run_retrieval() has taken in images 0 … image_count - 1, to the bit, in one pass
/// over their descriptors (two below the last training) and with one training at most. For resuming
/// a session.
/// @errors as run_retrieval()
Result<RetrievalState> rebuild_retrieval(std::shared_ptr<const Vocabulary> given,
                                         std::uint32_t image_count, const DescriptorSource& source,
                                         const RetrievalOptions& options,
                                         VocabularySource independent = {});

}  // namespace psfm
