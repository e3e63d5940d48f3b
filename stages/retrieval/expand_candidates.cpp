// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/expand_candidates.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

namespace psfm {
namespace {

/// Guard: nothing is divided by less: scores of images that resemble nothing are 0.
constexpr float kLeastScore = 1e-6F;
/// Guard: a score below all others that is not 0, which would say that nothing was compared.
constexpr float kLeastPart = 1e-3F;

using Scores = std::unordered_map<std::uint32_t, float>;

/// What the similar images say of their neighbours, by image.
Scores vouch(std::span<const ScoredImage> similar, const ViewGraph& view_graph) {
    Scores scores;
    const float least = similar.back().score;
    for (const ScoredImage& known : similar) {
        const auto edges = view_graph.edges(static_cast<ImageId>(known.image));
        const double strongest =
            edges.empty() ? 0.0 : std::ranges::max(edges, {}, &ViewGraph::Edge::weight).weight;
        if (strongest <= 0.0) continue;
        for (const ViewGraph::Edge& edge : edges) {
            const auto part = static_cast<float>(edge.weight / strongest);
            scores[static_cast<std::uint32_t>(index_of(edge.neighbor))] +=
                part * (known.score - least);
        }
    }
    return scores;
}

/// Of so many candidates of an image, those that others vouch for.
std::size_t vouched_candidates(std::size_t count, std::size_t images,
                               const RetrievalOptions& options) {
    const double similar_up_to = options.vouched_beyond * static_cast<double>(count);
    const double beyond = static_cast<double>(images) - similar_up_to;
    if (beyond <= 0.0) return 0;
    return static_cast<std::size_t>(std::lround(options.vouched_part * static_cast<double>(count) *
                                                beyond / static_cast<double>(images)));
}

}  // namespace

std::vector<ScoredImage> expand_candidates(std::span<const ScoredImage> similar,
                                           const ViewGraph& view_graph,
                                           const RetrievalOptions& options) {
    const std::size_t count = options.candidates;
    const std::size_t vouched = vouched_candidates(count, view_graph.size(), options);
    similar = similar.first(std::min(similar.size(), count));
    const std::size_t asked = std::min(similar.size(), count - std::min(count, vouched));
    if (asked == similar.size()) return {similar.begin(), similar.end()};
    Scores scores = vouch(similar, view_graph);
    const float least = similar.back().score;
    for (const ScoredImage& other : similar.subspan(asked))
        scores[other.image] += other.score - least;
    std::vector<ScoredImage> candidates(similar.begin(),
                                        similar.begin() + static_cast<std::ptrdiff_t>(asked));
    for (const ScoredImage& taken : candidates) scores.erase(taken.image);
    std::vector<ScoredImage> others;
    others.reserve(scores.size());
    for (const auto& [image, score] : scores) others.push_back({image, score});
    std::ranges::sort(others, [](const ScoredImage& a, const ScoredImage& b) {
        return a.score != b.score ? a.score > b.score : a.image < b.image;
    });
    others.resize(std::min(others.size(), count - asked));
    // Behind the similar ones.
    const float highest = asked > 0 ? candidates.back().score : 1.F;
    const float first = std::max(others.front().score, kLeastScore);
    for (ScoredImage& other : others)
        other.score = highest * std::max(other.score / first, kLeastPart);
    candidates.insert(candidates.end(), others.begin(), others.end());
    return candidates;
}

}  // namespace psfm
