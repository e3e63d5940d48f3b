// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/view_graph.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace psfm {

ViewGraph::ViewGraph(std::span<const VerifiedPairPtr> pairs) : edge_count_(pairs.size()) {
    std::vector<Edges> adjacency;
    const auto add = [&](ImageId from, ImageId to, const VerifiedPairPtr& pair) {
        if (index_of(from) >= adjacency.size()) adjacency.resize(index_of(from) + 1);
        const auto weight = static_cast<double>(pair->geometry.inliers.size());
        adjacency[index_of(from)].push_back({to, weight, pair});
    };
    for (const VerifiedPairPtr& pair : pairs) {
        add(pair->pair.first, pair->pair.second, pair);
        add(pair->pair.second, pair->pair.first, pair);
    }
    for (Edges& edges : adjacency) {
        std::ranges::sort(edges, {}, &Edge::neighbor);
        set_edges(add_node(), std::move(edges));
    }
}

ImageId ViewGraph::add_node() {
    if (size_ % kBlockNodes == 0) blocks_.emplace_back();
    return static_cast<ImageId>(size_++);
}

void ViewGraph::add_edge(ImageId a, ImageId b, double weight, VerifiedPairPtr pair) {
    assert(a != b && weight > 0.0 && find(a, b) == nullptr);
    const auto insert = [&](ImageId from, ImageId to) {
        const std::span<const Edge> before = edges(from);
        const auto place = std::ranges::lower_bound(before, to, {}, &Edge::neighbor);
        Edges after;
        after.reserve(before.size() + 1);
        after.assign(before.begin(), place);
        after.push_back({to, weight, pair});
        after.insert(after.end(), place, before.end());
        set_edges(from, std::move(after));
    };
    insert(a, b);
    insert(b, a);
    ++edge_count_;
}

void ViewGraph::remove_edge(ImageId a, ImageId b) {
    assert(find(a, b) != nullptr);
    const auto remove = [&](ImageId from, ImageId to) {
        const std::span<const Edge> before = edges(from);
        Edges after(before.begin(), before.end());
        after.erase(std::ranges::lower_bound(after, to, {}, &Edge::neighbor));
        set_edges(from, std::move(after));
    };
    remove(a, b);
    remove(b, a);
    --edge_count_;
}

std::span<const ViewGraph::Edge> ViewGraph::edges(ImageId image) const {
    const std::size_t block = index_of(image) / kBlockNodes;
    if (block >= blocks_.size() || !blocks_[block]) return {};
    const auto& own = blocks_[block]->at(index_of(image) % kBlockNodes);
    return own ? std::span<const Edge>(*own) : std::span<const Edge>();
}

const ViewGraph::Edge* ViewGraph::find(ImageId a, ImageId b) const {
    const std::span<const Edge> own = edges(a);
    const auto found = std::ranges::lower_bound(own, b, {}, &Edge::neighbor);
    return found != own.end() && found->neighbor == b ? &*found : nullptr;
}

void ViewGraph::set_edges(ImageId image, Edges edges) {
    auto& block = blocks_[index_of(image) / kBlockNodes];
    auto changed = block ? std::make_shared<Block>(*block) : std::make_shared<Block>();
    changed->at(index_of(image) % kBlockNodes) =
        edges.empty() ? nullptr : std::make_shared<const Edges>(std::move(edges));
    block = std::move(changed);
}

}  // namespace psfm
