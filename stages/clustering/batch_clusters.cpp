// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/batch_clusters.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "stages/clustering/jaccard_distance.h"

namespace psfm {

std::vector<std::vector<ImageId>> batch_clusters(const ViewGraph& graph,
                                                 const ClusteringOptions& options) {
    std::vector<std::vector<ImageId>> clusters;
    std::vector<bool> seen(graph.size(), false);
    for (std::uint32_t first = 0; first < graph.size(); ++first) {
        if (seen[first]) continue;
        seen[first] = true;
        std::vector<ImageId> found{static_cast<ImageId>(first)};
        for (std::size_t at = 0; at < found.size(); ++at) {
            const ImageId image = found[at];
            for (const ViewGraph::Edge& edge : graph.edges(image)) {
                if (seen[index_of(edge.neighbor)]) continue;
                if (jaccard_sums(graph, image, edge.neighbor, options.form)
                        .nearer_than(options.eta)) {
                    seen[index_of(edge.neighbor)] = true;
                    found.push_back(edge.neighbor);
                }
            }
        }
        std::ranges::sort(found);
        clusters.push_back(std::move(found));
    }
    return clusters;
}

}  // namespace psfm
