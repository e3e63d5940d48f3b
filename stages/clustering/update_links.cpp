// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/update_links.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "stages/clustering/jaccard_distance.h"

namespace psfm {
namespace {

/// Neighbours nearer than eta or rescued, ascending. Scatters the image's weights, so that a
/// neighbour costs its own edges only; sums in the same order as jaccard_sums of a graph, hence the
/// same bits.
std::vector<ImageId> linked_neighbors(ClusteringState& state, const ViewGraph& graph, ImageId image,
                                      const ClusteringOptions& options) {
    std::vector<double>& weight = state.workspace.weight;
    const std::span<const ViewGraph::Edge> edges = graph.edges(image);
    for (const ViewGraph::Edge& edge : edges) weight[index_of(edge.neighbor)] = edge.weight;
    std::vector<ImageId> linked;
    for (const ViewGraph::Edge& edge : edges) {
        double common = 0.0;
        for (const ViewGraph::Edge& next : graph.edges(edge.neighbor)) {
            const double own = weight[index_of(next.neighbor)];
            if (own > 0.0 && next.weight > 0.0) common += own + next.weight;
        }
        const double degrees =
            state.degrees[index_of(image)] + state.degrees[index_of(edge.neighbor)];
        const JaccardSums sums = jaccard_sums(common, edge.weight, degrees, options.form);
        const bool is_near = edge.weight > 0.0 && sums.nearer_than(options.eta);
        if (is_near || std::ranges::binary_search(state.rescued[index_of(image)], edge.neighbor))
            linked.push_back(edge.neighbor);
    }
    for (const ViewGraph::Edge& edge : edges) weight[index_of(edge.neighbor)] = 0.0;
    return linked;
}

void insert_sorted(std::vector<ImageId>& ids, ImageId id) {
    const auto at = std::ranges::lower_bound(ids, id);
    if (at == ids.end() || *at != id) ids.insert(at, id);
}

void erase_sorted(std::vector<ImageId>& ids, ImageId id) {
    const auto at = std::ranges::lower_bound(ids, id);
    if (at != ids.end() && *at == id) ids.erase(at);
}

}  // namespace

void set_rescued(ClusteringState& state, const ImagePair& pair) {
    for (auto* neighbors : {&state.rescued, &state.links}) {
        insert_sorted((*neighbors)[index_of(pair.first)], pair.second);
        insert_sorted((*neighbors)[index_of(pair.second)], pair.first);
    }
}

LinkChanges update_links(ClusteringState& state, const ViewGraph& graph,
                         std::span<const ImageId> touched, const ClusteringOptions& options) {
    for (const ImageId image : touched)
        state.degrees[index_of(image)] = weighted_degree(graph, image);
    LinkChanges changes;
    std::vector<ImageId> gained;
    std::vector<ImageId> lost;
    for (const ImageId image : touched) {
        std::vector<ImageId> linked = linked_neighbors(state, graph, image, options);
        std::vector<ImageId>& known = state.links[index_of(image)];
        gained.clear();
        lost.clear();
        std::ranges::set_difference(linked, known, std::back_inserter(gained));
        std::ranges::set_difference(known, linked, std::back_inserter(lost));
        known = std::move(linked);
        for (const ImageId other : gained) {
            insert_sorted(state.links[index_of(other)], image);
            changes.added.push_back(ImagePair::of(image, other));
        }
        for (const ImageId other : lost) {
            erase_sorted(state.links[index_of(other)], image);
            changes.removed.push_back(ImagePair::of(image, other));
        }
    }
    // Both ends of a pair come to the same verdict, so that the second one finds nothing to change.
    std::ranges::sort(changes.added);
    std::ranges::sort(changes.removed);
    return changes;
}

}  // namespace psfm
