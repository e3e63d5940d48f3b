// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/view_graph.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace psfm {

ViewGraph::ViewGraph(std::span<const VerifiedPairPtr> pairs) : edge_count_(pairs.size()) {
    struct End {
        ImageId image{};
        Edge edge;
    };
    std::vector<End> ends;
    ends.reserve(2 * pairs.size());
    for (const VerifiedPairPtr& pair : pairs) {
        const auto weight = static_cast<double>(pair->geometry.inliers.size());
        ends.push_back({pair->pair.first, {pair->pair.second, weight, pair}});
        ends.push_back({pair->pair.second, {pair->pair.first, weight, pair}});
    }
    if (ends.empty()) return;
    std::ranges::sort(ends, {},
                      [](const End& end) { return std::pair(end.image, end.edge.neighbor); });
    // Images may be few of very many: those between them cost nothing but a place each block.
    size_ = index_of(ends.back().image) + 1;
    blocks_.resize((size_ + kBlockNodes - 1) / kBlockNodes);
    for (auto end = ends.begin(); end != ends.end();) {
        const ImageId image = end->image;
        Edges own;
        for (; end != ends.end() && end->image == image; ++end) own.push_back(std::move(end->edge));
        set_edges(image, std::move(own));
    }
}

ImageId ViewGraph::add_node() {
    if (size_ % kBlockNodes == 0) blocks_.emplace_back();
    return static_cast<ImageId>(size_++);
}

void ViewGraph::add_edge(ImageId a, ImageId b, double weight, VerifiedPairPtr pair) {
    assert(a != b && weight >= 0.0 && find(a, b) == nullptr);
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
