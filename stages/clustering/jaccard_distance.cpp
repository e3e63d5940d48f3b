// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/jaccard_distance.h"

#include <span>

namespace psfm {

double weighted_degree(const ViewGraph& graph, ImageId image) {
    double sum = 0.0;
    for (const ViewGraph::Edge& edge : graph.edges(image)) sum += edge.weight;
    return sum;
}

JaccardSums jaccard_sums(const ViewGraph& graph, ImageId i, ImageId j, JaccardForm form) {
    const std::span<const ViewGraph::Edge> edges_i = graph.edges(i);
    const std::span<const ViewGraph::Edge> edges_j = graph.edges(j);
    double common = 0.0;
    double direct = 0.0;
    auto at_j = edges_j.begin();
    for (const ViewGraph::Edge& edge : edges_i) {
        if (edge.neighbor == j) direct = edge.weight;
        while (at_j != edges_j.end() && at_j->neighbor < edge.neighbor) ++at_j;
        if (at_j != edges_j.end() && at_j->neighbor == edge.neighbor && edge.weight > 0.0 &&
            at_j->weight > 0.0) {
            common += edge.weight + at_j->weight;
        }
    }
    return jaccard_sums(common, direct, weighted_degree(graph, i) + weighted_degree(graph, j),
                        form);
}

}  // namespace psfm
