// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/view_graph.h"

#include <algorithm>
#include <cassert>

namespace psfm {

ImageId ViewGraph::add_node() {
    adjacency_.emplace_back();
    return static_cast<ImageId>(adjacency_.size() - 1);
}

void ViewGraph::add_edge(ImageId a, ImageId b, double weight, VerifiedPairPtr pair) {
    assert(a != b && weight > 0.0 && find(a, b) == nullptr);
    const auto insert = [&](ImageId from, ImageId to) {
        std::vector<Edge>& edges = adjacency_[index_of(from)];
        edges.insert(std::ranges::lower_bound(edges, to, {}, &Edge::neighbor),
                     Edge{to, weight, pair});
    };
    insert(a, b);
    insert(b, a);
    ++edge_count_;
}

void ViewGraph::remove_edge(ImageId a, ImageId b) {
    assert(find(a, b) != nullptr);
    const auto remove = [&](ImageId from, ImageId to) {
        std::vector<Edge>& edges = adjacency_[index_of(from)];
        edges.erase(std::ranges::lower_bound(edges, to, {}, &Edge::neighbor));
    };
    remove(a, b);
    remove(b, a);
    --edge_count_;
}

const ViewGraph::Edge* ViewGraph::find(ImageId a, ImageId b) const {
    const std::vector<Edge>& edges = adjacency_[index_of(a)];
    const auto found = std::ranges::lower_bound(edges, b, {}, &Edge::neighbor);
    return found != edges.end() && found->neighbor == b ? &*found : nullptr;
}

}  // namespace psfm
