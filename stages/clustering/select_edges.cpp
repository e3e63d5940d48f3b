// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/select_edges.h"

#include <algorithm>
#include <cassert>
#include <set>
#include <utility>

#include "stages/clustering/apply_selection.h"

namespace psfm {
namespace {

Error invalid(const char* what) {
    return {ErrorCode::kInvalidArgument, std::string("edge selection: ") + what};
}

bool is_plausible(const EdgeSelection& selection, ImageId a, ImageId b, double plausible,
                  const EdgeSelectionOptions& options) {
    const double reached = std::min(selection.best[index_of(a)], selection.best[index_of(b)]);
    return plausible >= options.min_relative_plausibility * reached;
}

void add_pair(std::vector<std::vector<EdgeSelection::Edge>>& edges, const VerifiedPairPtr& pair,
              double plausible) {
    const auto [a, b] = pair->pair;
    edges[index_of(a)].push_back({b, plausible, pair});
    edges[index_of(b)].push_back({a, plausible, pair});
}

bool has_inliers(const VerifiedPairPtr& pair, std::uint32_t least) {
    return pair->geometry.inliers.size() >= least;
}

/// Takes out the pairs of an image that its best pair has outdone.
void drop_outdone(EdgeSelection& selection, ImageId image, const EdgeSelectionOptions& options,
                  std::set<ImagePair>& changed) {
    std::vector<EdgeSelection::Edge>& edges = selection.edges[index_of(image)];
    const auto outdone = std::ranges::stable_partition(edges, [&](const EdgeSelection::Edge& edge) {
        return is_plausible(selection, image, edge.neighbor, edge.plausibility, options);
    });
    for (EdgeSelection::Edge& edge : outdone) {
        const ImageId other = edge.neighbor;
        std::erase_if(selection.edges[index_of(other)],
                      [&](const EdgeSelection::Edge& back) { return back.neighbor == image; });
        changed.insert(ImagePair::of(image, other));
        if (options.min_weak_inliers > 0) add_pair(selection.weak, edge.pair, edge.plausibility);
    }
    edges.erase(outdone.begin(), outdone.end());
}

}  // namespace

Result<void> validate(const EdgeSelectionOptions& options) {
    if (options.min_inliers < 1) return invalid("min_inliers is 0; give at least 1");
    if (!(options.min_relative_plausibility >= 0.0 && options.min_relative_plausibility <= 1.0))
        return invalid("min_relative_plausibility is not between 0 and 1");
    if (const auto valid = validate(options.still); !valid.ok()) return valid.error();
    return validate(options.plausibility);
}

EdgeChanges select_edges(EdgeSelection& selection, ViewGraph& graph, ImageId image,
                         std::span<const VerifiedPairPtr> pairs,
                         const EdgeSelectionOptions& options) {
    [[maybe_unused]] const ImageId added = graph.add_node();
    assert(added == image);
    selection.edges.resize(graph.size());
    selection.weak.resize(graph.size());
    selection.best.resize(graph.size(), 0.0);
    selection.apart.resize(graph.size());
    selection.outvoted.resize(graph.size());
    selection.still.resize(graph.size());
    selection.still_only.resize(graph.size(), 0);
    selection.still_options = options.still;

    std::vector<ImageId> risen{image};
    const auto raise_best = [&](ImageId of, double plausible) {
        double& best = selection.best[index_of(of)];
        if (plausible <= best) return;
        best = plausible;
        if (of != image) risen.push_back(of);
    };
    for (const VerifiedPairPtr& pair : pairs) {
        if (is_still_only(pair->geometry)) {
            ++selection.still_only[index_of(pair->pair.first)];
            ++selection.still_only[index_of(pair->pair.second)];
        }
        // How well two photographs from one place match says nothing of those from others.
        if (!has_inliers(pair, options.min_inliers) || !shows_motion(pair->geometry)) continue;
        const double plausible = plausibility(pair->geometry, options.plausibility);
        raise_best(pair->pair.first, plausible);
        raise_best(pair->pair.second, plausible);
    }
    std::set<ImagePair> changed;
    for (const VerifiedPairPtr& pair : pairs) {
        const auto [a, b] = pair->pair;
        const double plausible = plausibility(pair->geometry, options.plausibility);
        const bool is_strong = has_inliers(pair, options.min_inliers) &&
                               is_plausible(selection, a, b, plausible, options);
        const bool is_weak = !is_strong && options.min_weak_inliers > 0 &&
                             has_inliers(pair, options.min_weak_inliers);
        if (!is_strong && !is_weak) continue;
        add_pair(is_strong ? selection.edges : selection.weak, pair, plausible);
        changed.insert(pair->pair);
    }
    for (const ImageId neighbor : risen) drop_outdone(selection, neighbor, options, changed);
    std::set<ImageId> recount;
    for (const auto& [a, b] : changed) recount.insert({a, b});
    EdgeChanges changes = apply_selection(selection, graph, recount, std::move(changed));
    const auto at = std::ranges::lower_bound(changes.images, image);
    if (at == changes.images.end() || *at != image) changes.images.insert(at, image);
    return changes;
}

}  // namespace psfm
