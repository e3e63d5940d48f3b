// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/apply_selection.h"

#include <algorithm>
#include <iterator>

namespace psfm {
namespace {

/// nullptr: the pair is not plausible
const EdgeSelection::Edge* find_plausible(const EdgeSelection& selection, const ImagePair& pair) {
    const auto& edges = selection.edges[index_of(pair.second)];
    const auto found = std::ranges::find(edges, pair.first, &EdgeSelection::Edge::neighbor);
    return found == edges.end() ? nullptr : &*found;
}

bool is_outvoted(const EdgeSelection& selection, const ImagePair& pair) {
    const auto& [a, b] = pair;
    return std::ranges::binary_search(selection.outvoted[index_of(a)], b) ||
           std::ranges::binary_search(selection.outvoted[index_of(b)], a);
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
    }
    std::set<ImageId> changed;
    EdgeChanges changes;
    for (const ImagePair& pair : pairs) {
        const auto& [a, b] = pair;
        const EdgeSelection::Edge* plausible = find_plausible(selection, pair);
        const bool is_edge =
            plausible != nullptr && !selection.are_apart(a, b) && !is_outvoted(selection, pair);
        if (is_edge == (graph.find(a, b) != nullptr)) continue;
        if (is_edge) {
            const auto inliers = static_cast<double>(plausible->pair->geometry.inliers.size());
            graph.add_edge(a, b, inliers, plausible->pair);
        } else {
            graph.remove_edge(a, b);
            changes.removed.push_back(pair);
        }
        changed.insert({a, b});
    }
    changes.images.assign(changed.begin(), changed.end());
    return changes;
}

}  // namespace psfm
