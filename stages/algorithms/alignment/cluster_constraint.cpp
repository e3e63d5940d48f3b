// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/cluster_constraint.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace psfm {
namespace {

/// Sum over the pairs of a mix of their numbers.
std::uint64_t hash_of(const std::vector<ImagePair>& pairs) {
    std::uint64_t sum = 0;
    for (const ImagePair& pair : pairs) {
        std::uint64_t value =
            (static_cast<std::uint64_t>(index_of(pair.first)) << 32U) | index_of(pair.second);
        value = (value ^ (value >> 31U)) * 0x7FB5D329728EA185ULL;
        value = (value ^ (value >> 27U)) * 0x81DADEF4BC2DD44DULL;
        sum += value ^ (value >> 33U);
    }
    return sum;
}

}  // namespace

ClusterPairEdgesPtr cluster_pair_edges(ClusterId a, ClusterId b, std::vector<VerifiedPairPtr> edges,
                                       std::vector<ImagePair> weak) {
    const auto pair_of = [](const VerifiedPairPtr& edge) { return edge->pair; };
    std::ranges::sort(edges, {}, pair_of);
    std::vector<ImagePair> matched;
    std::ranges::transform(edges, std::back_inserter(matched), pair_of);
    const std::uint64_t hash = hash_of(matched);
    std::ranges::move(weak, std::back_inserter(matched));
    std::ranges::sort(matched);
    const std::uint64_t matched_hash = hash_of(matched);
    return std::make_shared<const ClusterPairEdges>(
        ClusterPairEdges{a, b, std::move(edges), hash, std::move(matched), matched_hash});
}

const char* describe(ConstraintVerdict verdict) {
    switch (verdict) {
        case ConstraintVerdict::kAccepted:
            return "accepted";
        case ConstraintVerdict::kNoEdges:
            return "no image pair sees enough points of both models";
        case ConstraintVerdict::kNoSimilarity:
            return "no image pair's points agree on a similarity";
        case ConstraintVerdict::kInterleaved:
            return "every similarity found would interleave the cameras of the two models";
        case ConstraintVerdict::kInconsistent:
            return "the image pairs contradict one another";
    }
    return "unknown";
}

}  // namespace psfm
