// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/apply_selection.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace psfm {
namespace {

/// nullptr: the pair is not among them
const EdgeSelection::Edge* find_pair(const std::vector<std::vector<EdgeSelection::Edge>>& edges,
                                     const ImagePair& pair) {
    const auto& of_second = edges[index_of(pair.second)];
    const auto found = std::ranges::find(of_second, pair.first, &EdgeSelection::Edge::neighbor);
    return found == of_second.end() ? nullptr : &*found;
}

/// Whether an image is apart from a plausible neighbour of the other one, or the other way round: a
/// weak edge is no evidence against that.
bool is_opposed(const EdgeSelection& selection, const ImagePair& pair) {
    if (selection.apart_count == 0) return false;
    const auto opposed = [&](ImageId a, ImageId b) {
        return std::ranges::any_of(
            selection.edges[index_of(a)],
            [&](const EdgeSelection::Edge& edge) { return selection.are_apart(edge.neighbor, b); });
    };
    return opposed(pair.first, pair.second) || opposed(pair.second, pair.first);
}

bool is_outvoted(const EdgeSelection& selection, const ImagePair& pair) {
    const auto& [a, b] = pair;
    return std::ranges::binary_search(selection.outvoted[index_of(a)], b) ||
           std::ranges::binary_search(selection.outvoted[index_of(b)], a);
}

/// Looks again for what stands still in an image. @return whether it is something else than before
bool update_still(EdgeSelection& selection, ImageId image) {
    std::vector<VerifiedPairPtr> pairs;
    for (const EdgeSelection::Edge& edge : selection.edges[index_of(image)])
        pairs.push_back(edge.pair);
    std::vector<std::uint32_t> now = still_features(image, pairs, selection.still_options);
    std::vector<std::uint32_t>& before = selection.still[index_of(image)];
    if (now == before) return false;
    before = std::move(now);
    return true;
}

/// A pair as the view graph has it.
struct ChosenEdge {
    VerifiedPairPtr pair;  ///< null: it is no edge
    double weight = 0.0;   ///< its inliers; 0: it is a weak edge
};

ChosenEdge choose_edge(const EdgeSelection& selection, const ImagePair& pair) {
    if (selection.are_apart(pair.first, pair.second)) return {};
    const EdgeSelection::Edge* plausible = find_pair(selection.edges, pair);
    const EdgeSelection::Edge* chosen = plausible ? plausible : find_pair(selection.weak, pair);
    if (chosen == nullptr) return {};
    if (plausible ? is_outvoted(selection, pair) : is_opposed(selection, pair)) return {};
    VerifiedPairPtr seen =
        without_still(chosen->pair, selection.still[index_of(pair.first)],
                      selection.still[index_of(pair.second)], selection.still_options);
    if (!seen) return {};
    const auto inliers = static_cast<double>(seen->geometry.inliers.size());
    return {std::move(seen), plausible ? inliers : 0.0};
}

/// A neighbour with what stands for it and against it.
struct Candidate {
    ImageId image{};
    double weight = 0.0;
    double opposition = 0.0;
};

}  // namespace

bool EdgeSelection::are_apart(ImageId a, ImageId b) const {
    return std::ranges::binary_search(apart[index_of(a)], b);
}

std::vector<ImageId> outvoted_neighbors(const EdgeSelection& selection, ImageId image) {
    std::vector<ImageId> outvoted;
    if (selection.apart_count == 0) return outvoted;
    std::vector<Candidate> candidates;
    for (const EdgeSelection::Edge& edge : selection.edges[index_of(image)]) {
        if (selection.are_apart(image, edge.neighbor)) continue;
        const auto inliers = static_cast<double>(edge.pair->geometry.inliers.size());
        candidates.push_back({edge.neighbor, inliers * edge.plausibility, 0.0});
    }
    std::ranges::sort(candidates, {}, &Candidate::image);
    /// body(candidate that is apart from this one)
    const auto for_each_opponent = [&](const Candidate& candidate, const auto& body) {
        for (const ImageId other : selection.apart[index_of(candidate.image)]) {
            const auto found = std::ranges::lower_bound(candidates, other, {}, &Candidate::image);
            if (found != candidates.end() && found->image == other) body(*found);
        }
    };
    for (Candidate& candidate : candidates) {
        for_each_opponent(candidate,
                          [&](const Candidate& other) { candidate.opposition += other.weight; });
    }
    for (const Candidate& candidate : candidates) {
        bool loses = false;
        for_each_opponent(candidate, [&](const Candidate& other) {
            loses = loses || other.opposition < candidate.opposition;
        });
        if (loses) outvoted.push_back(candidate.image);
    }
    return outvoted;
}

EdgeChanges apply_selection(EdgeSelection& selection, ViewGraph& graph,
                            const std::set<ImageId>& images, std::set<ImagePair> pairs) {
    for (const ImageId image : images) {
        std::vector<ImageId> now = outvoted_neighbors(selection, image);
        std::vector<ImageId>& before = selection.outvoted[index_of(image)];
        std::vector<ImageId> differing;
        std::ranges::set_symmetric_difference(before, now, std::back_inserter(differing));
        for (const ImageId other : differing) pairs.insert(ImagePair::of(image, other));
        before = std::move(now);
        // Whether these are opposed may have changed with the image's neighbours.
        const bool is_still_changed = update_still(selection, image);
        if (selection.apart_count > 0 || is_still_changed) {
            for (const EdgeSelection::Edge& edge : selection.weak[index_of(image)])
                pairs.insert(edge.pair->pair);
        }
        if (!is_still_changed) continue;
        for (const EdgeSelection::Edge& edge : selection.edges[index_of(image)])
            pairs.insert(edge.pair->pair);
    }
    std::set<ImageId> changed;
    EdgeChanges changes;
    for (const ImagePair& pair : pairs) {
        const auto& [a, b] = pair;
        ChosenEdge now = choose_edge(selection, pair);
        const ViewGraph::Edge* edge = graph.find(a, b);
        const bool same = edge == nullptr
                              ? now.pair == nullptr
                              : now.pair != nullptr && edge->weight == now.weight &&
                                    (edge->pair == now.pair ||
                                     edge->pair->geometry.inliers == now.pair->geometry.inliers);
        if (same) continue;
        // What models rest on: what is an edge still has gained if it was a weak one.
        const bool is_raised =
            edge != nullptr && now.pair && edge->weight < now.weight && edge->pair == now.pair;
        if (edge != nullptr) {
            graph.remove_edge(a, b);
            if (!is_raised) changes.removed.push_back(pair);
        }
        if (now.pair) graph.add_edge(a, b, now.weight, std::move(now.pair));
        changed.insert({a, b});
    }
    changes.images.assign(changed.begin(), changed.end());
    return changes;
}

}  // namespace psfm
