// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/rescue_links.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "stages/algorithms/math/union_find.h"
#include "stages/clustering/plausibility.h"

namespace psfm {
namespace {

/// Groups that grow together, with whether they are large enough already.
class GrowingGroups {
  public:
    explicit GrowingGroups(std::uint32_t enough) : enough_(enough) {}

    std::uint32_t add(bool is_large) {
        size_.push_back(is_large ? enough_ : 1);
        return sets_.add();
    }
    /// @return whether they were two
    bool join(std::uint32_t a, std::uint32_t b) {
        a = sets_.root_of(a);
        b = sets_.root_of(b);
        if (a == b) return false;
        sets_.attach(b, a);
        size_[a] = std::min(enough_, size_[a] + size_[b]);
        return true;
    }
    bool is_large(std::uint32_t group) { return size_[sets_.root_of(group)] >= enough_; }

  private:
    std::uint32_t enough_;
    UnionFind<> sets_;
    std::vector<std::uint32_t> size_;  // up to enough_
};

double strength_of(const ViewGraph::Edge& edge) {
    if (!edge.pair) return edge.weight;
    return static_cast<double>(edge.pair->geometry.inliers.size()) *
           plausibility(edge.pair->geometry, PlausibilityOptions{});
}

/// Joins groups of images along the strongest edges that they have.
class Kruskal {
  public:
    Kruskal(const NearNeighbors& near, std::span<const ImageId> images, std::uint32_t enough)
        : images_(images), groups_(enough) {
        for (const ImageId image : images) group_of_.emplace(image, groups_.add(false));
        for (const ImageId image : images) {
            for (const ImageId other : near[index_of(image)]) {
                if (const auto found = group_of_.find(other); found != group_of_.end())
                    groups_.join(group_of_.at(image), found->second);
            }
        }
    }

    /// @param lead_out  also along edges to other images, which are large groups, each by itself
    std::vector<ImagePair> links(const ViewGraph& graph, bool lead_out) {
        // (is weak, -strength, pair): best first, and among equals the earlier images.
        std::vector<std::tuple<bool, double, ImagePair>> edges;
        for (const ImageId image : images_) {
            for (const ViewGraph::Edge& edge : graph.edges(image)) {
                if (!group_of_.contains(edge.neighbor)) {
                    if (!lead_out) continue;
                    group_of_.emplace(edge.neighbor, groups_.add(/*is_large=*/true));
                }
                edges.emplace_back(edge.weight == 0.0, -strength_of(edge),
                                   ImagePair::of(image, edge.neighbor));
            }
        }
        std::ranges::sort(edges);
        std::vector<ImagePair> links;
        for (const auto& [is_weak, strength, pair] : edges) {
            const std::uint32_t a = group_of_.at(pair.first);
            const std::uint32_t b = group_of_.at(pair.second);
            if (groups_.is_large(a) && groups_.is_large(b)) continue;
            if (groups_.join(a, b)) links.push_back(pair);
        }
        std::ranges::sort(links);
        return links;
    }

  private:
    std::span<const ImageId> images_;
    GrowingGroups groups_;
    std::map<ImageId, std::uint32_t> group_of_;
};

}  // namespace

std::vector<ImageId> small_group(const NearNeighbors& near, ImageId image, std::uint32_t at_least) {
    std::vector<ImageId> found{image};
    for (std::size_t at = 0; at < found.size() && found.size() < at_least; ++at) {
        for (const ImageId next : near[index_of(found[at])]) {
            if (found.size() >= at_least) break;
            if (std::ranges::find(found, next) == found.end()) found.push_back(next);
        }
    }
    return found;
}

std::vector<ImageId> in_small_groups(const NearNeighbors& near, std::uint32_t join_below) {
    std::vector<ImageId> images;
    for (std::size_t i = 0; i < near.size(); ++i) {
        const auto image = static_cast<ImageId>(i);
        if (small_group(near, image, join_below).size() < join_below) images.push_back(image);
    }
    return images;
}

std::vector<ImagePair> rescue_links(const NearNeighbors& near, const ViewGraph& graph,
                                    std::span<const ImageId> images, std::uint32_t join_below) {
    return Kruskal(near, images, join_below).links(graph, /*lead_out=*/true);
}

std::vector<ImagePair> links_within(const NearNeighbors& near, const ViewGraph& graph,
                                    std::span<const ImageId> images) {
    const auto all = static_cast<std::uint32_t>(images.size());
    return Kruskal(near, images, all).links(graph, /*lead_out=*/false);
}

}  // namespace psfm
