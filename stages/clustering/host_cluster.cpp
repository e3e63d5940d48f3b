// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/host_cluster.h"

#include <algorithm>
#include <map>

#include "graph/sorted_unique.h"
#include "stages/clustering/clustering_options.h"

namespace psfm {
namespace {

bool is_large(const ClusteringState& clustering, ImageId image, std::uint32_t mu_min) {
    return makes_model(clustering.members.at(clustering.cluster_of[index_of(image)]).size(),
                       mu_min);
}

}  // namespace

std::optional<ClusterId> host_cluster(const ViewGraph& graph, const ClusteringState& clustering,
                                      ImageId image, std::uint32_t mu_min) {
    if (is_large(clustering, image, mu_min)) return std::nullopt;
    std::map<ClusterId, double> shared;
    for (const ViewGraph::Edge& edge : graph.edges(image)) {
        if (edge.weight > 0.0 && is_large(clustering, edge.neighbor, mu_min)) {
            shared[clustering.cluster_of[index_of(edge.neighbor)]] += edge.weight;
        }
    }
    // max_element returns the first of equals, and the map is ascending by id.
    const auto best =
        std::ranges::max_element(shared, {}, [](const auto& entry) { return entry.second; });
    if (best == shared.end()) return std::nullopt;
    return best->first;
}

std::vector<ImageId> images_to_host_again(const ViewGraph& graph, const ClusteringState& clustering,
                                          std::span<const ImageId> changed, std::uint32_t mu_min) {
    std::vector<ImageId> images;
    const auto add = [&](ImageId image) {
        if (!is_large(clustering, image, mu_min)) images.push_back(image);
    };
    for (const ImageId image : changed) {
        images.push_back(image);  // large or not: it may have been a guest until now
        for (const ViewGraph::Edge& edge : graph.edges(image)) add(edge.neighbor);
    }
    sort_unique(images);
    return images;
}

}  // namespace psfm
