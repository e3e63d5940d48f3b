// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "graph/view_graph.h"
#include "stages/retrieval/inverted_file.h"
#include "stages/retrieval/retrieval_options.h"

namespace psfm {

/// The images most similar to a query, and behind them what these have edges with: the larger a
/// collection, the less words tell of what overlaps, but images of one place know each other. A
/// similar image vouches for its neighbours with its score above the least one, in proportion to
/// the weights of its edges. Query expansion (Chum et al., ICCV 2007) by the view graph instead of
/// by features (ours; docs/retrieval.md).
/// @param similar  of InvertedFile::most_similar, descending by score
/// @param view_graph  images are numbered as the index has them; may be without some
/// @return at most options.candidates, of them options.vouched_part at most that others vouch for,
/// fewer the smaller the collection (vouched_beyond): similar ones first, then the others, each
/// descending by score, then ascending by image; scores of the others are below those of the first
/// Deterministic. Cost: O(edges of the similar images). Thread-safe.
std::vector<ScoredImage> expand_candidates(std::span<const ScoredImage> similar,
                                           const ViewGraph& view_graph,
                                           const RetrievalOptions& options);

}  // namespace psfm
