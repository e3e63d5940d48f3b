// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/edges_between_clusters.h"

#include <algorithm>

#include "stages/merge/consistency/weak_matches.h"

namespace psfm {

std::vector<ClusterPairEdgesPtr> EdgesBetweenClusters::update(
    const ClusterTable& clusters, const ViewGraph& view_graph,
    const ClusterConstraintOptions& options) {
    std::vector<ClusterId> outdated;
    for (const auto& [id, placed] : placed_) {
        const auto entry = clusters.entries().find(id);
        if (entry == clusters.entries().end() ||
            entry->second.published.placing_changes != placed.changes)
            outdated.push_back(id);
    }
    forget(outdated);
    placing_.resize(view_graph.size());
    std::vector<ClusterId> changed;
    for (const auto& [id, entry] : clusters.entries()) {
        if (placed_.contains(id)) continue;
        changed.push_back(id);
        Placed& placed = placed_[id];
        placed.changes = entry.published.placing_changes;
        if (!entry.published.model) continue;
        for (const RegisteredImage& image : entry.published.model->images) {
            // Until a cluster that lost an image is solved again, two models have it.
            if (clusters.of(image.image).id != id) continue;
            placed.images.push_back(image.image);
            placing_[index_of(image.image)] = id;
        }
    }
    for (auto& [pair, found] : collect(changed, view_graph, options)) {
        between_[pair] = cluster_pair_edges(pair.first, pair.second, std::move(found.edges),
                                            std::move(found.weak));
    }
    std::vector<ClusterPairEdgesPtr> pairs;
    pairs.reserve(between_.size());
    for (const auto& [pair, edges] : between_) pairs.push_back(edges);
    return pairs;
}

void EdgesBetweenClusters::forget(const std::vector<ClusterId>& clusters) {
    for (const ClusterId id : clusters) {
        const auto placed = placed_.find(id);
        for (const ImageId image : placed->second.images) placing_[index_of(image)].reset();
        placed_.erase(placed);
    }
    std::erase_if(between_, [&](const auto& pair) {
        return !placed_.contains(pair.first.first) || !placed_.contains(pair.first.second);
    });
}

std::map<EdgesBetweenClusters::ClusterPair, EdgesBetweenClusters::Found>
EdgesBetweenClusters::collect(const std::vector<ClusterId>& changed, const ViewGraph& view_graph,
                              const ClusterConstraintOptions& options) const {
    WeakMatches matches(view_graph, options.min_weak_part);
    std::map<ClusterPair, Found> between;
    for (const ClusterId cluster : changed) {
        for (const ImageId image : placed_.at(cluster).images) {
            for (const ViewGraph::Edge& edge : view_graph.edges(image)) {
                const std::optional<ClusterId>& other = placing_[index_of(edge.neighbor)];
                if (!other || *other == cluster) continue;
                // Where both have changed, it is found from the first one.
                if (*other < cluster && std::ranges::binary_search(changed, *other)) continue;
                const bool is_weak = edge.weight == 0.0;
                if (is_weak && !matches.match(*edge.pair)) continue;
                Found& found = between[std::minmax(cluster, *other)];
                if (is_weak) {
                    found.weak.push_back(ImagePair::of(image, edge.neighbor));
                } else {
                    found.edges.push_back(edge.pair);
                }
            }
        }
    }
    return between;
}

ClusterPairEdgesPtr verified_between(const EdgeSelection& selection, const ViewGraph& graph,
                                     const ClusterEntry& a, const ClusterEntry& b,
                                     const ClusterConstraintOptions& options) {
    WeakMatches matches(graph, options.min_weak_part);
    std::vector<VerifiedPairPtr> edges;
    std::vector<ImagePair> weak;
    const Reconstruction& others = *b.published.model;
    for (const RegisteredImage& image : a.published.model->images) {
        for (const EdgeSelection::Edge& edge : selection.edges[index_of(image.image)]) {
            if (others.find(edge.neighbor) != nullptr) edges.push_back(edge.pair);
        }
        for (const EdgeSelection::Edge& edge : selection.weak[index_of(image.image)]) {
            if (others.find(edge.neighbor) != nullptr && matches.match(*edge.pair))
                weak.push_back(edge.pair->pair);
        }
    }
    return cluster_pair_edges(a.id, b.id, std::move(edges), std::move(weak));
}

}  // namespace psfm
