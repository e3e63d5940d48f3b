// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/batch_clusters.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "stages/clustering/jaccard_distance.h"
#include "stages/clustering/rescue_links.h"

namespace psfm {

namespace {

NearNeighbors near_neighbors(const ViewGraph& graph, const ClusteringOptions& options) {
    NearNeighbors near(graph.size());
    for (std::uint32_t i = 0; i < graph.size(); ++i) {
        const auto image = static_cast<ImageId>(i);
        for (const ViewGraph::Edge& edge : graph.edges(image)) {
            if (edge.weight > 0.0 &&
                jaccard_sums(graph, image, edge.neighbor, options.form).nearer_than(options.eta))
                near[i].push_back(edge.neighbor);
        }
    }
    return near;
}

/// Near ones, and what rescues the groups that are too small.
NearNeighbors links_of(const ViewGraph& graph, const ClusteringOptions& options) {
    NearNeighbors links = near_neighbors(graph, options);
    const std::vector<ImageId> small = in_small_groups(links, options.join_below);
    for (const auto& [a, b] : rescue_links(links, graph, small, options.join_below)) {
        links[index_of(a)].push_back(b);
        links[index_of(b)].push_back(a);
    }
    return links;
}

}  // namespace

std::vector<std::vector<ImageId>> batch_clusters(const ViewGraph& graph,
                                                 const ClusteringOptions& options) {
    const NearNeighbors links = links_of(graph, options);
    std::vector<std::vector<ImageId>> clusters;
    std::vector<bool> seen(graph.size(), false);
    for (std::uint32_t first = 0; first < graph.size(); ++first) {
        if (seen[first]) continue;
        seen[first] = true;
        std::vector<ImageId> found{static_cast<ImageId>(first)};
        for (std::size_t at = 0; at < found.size(); ++at) {
            for (const ImageId next : links[index_of(found[at])]) {
                if (seen[index_of(next)]) continue;
                seen[index_of(next)] = true;
                found.push_back(next);
            }
        }
        std::ranges::sort(found);
        clusters.push_back(std::move(found));
    }
    return clusters;
}

}  // namespace psfm
