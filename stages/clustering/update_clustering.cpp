// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/update_clustering.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "graph/sorted_unique.h"
#include "stages/clustering/apply_relabelling.h"
#include "stages/clustering/find_split_parts.h"
#include "stages/clustering/relabeller.h"
#include "stages/clustering/rescue_links.h"
#include "stages/clustering/update_links.h"

namespace psfm {
namespace {

/// Joins along links, those of most weight first: an image between clusters that may not join
/// belongs to the one that it has most in common with.
void join_along(Relabeller& relabeller, const ViewGraph& graph,
                const std::vector<ImagePair>& links) {
    std::vector<std::pair<double, ImagePair>> weighted;
    weighted.reserve(links.size());
    for (const ImagePair& link : links)
        weighted.emplace_back(-graph.find(link.first, link.second)->weight, link);
    std::ranges::sort(weighted);
    for (const auto& [weight, link] : weighted) relabeller.join(link.first, link.second);
}

/// Links from these images to other clusters.
std::vector<ImagePair> links_out_of(const ClusteringState& state,
                                    const std::vector<ImageId>& images) {
    std::vector<ImagePair> links;
    for (const ImageId image : images) {
        for (const ImageId other : state.links[index_of(image)]) {
            if (state.cluster_of[index_of(other)] != state.cluster_of[index_of(image)])
                links.push_back(ImagePair::of(image, other));
        }
    }
    return links;
}

/// Splits what lost links held together, and joins what was held apart only for its size.
void split_along(Relabeller& relabeller, ClusteringState& state, const ViewGraph& graph,
                 const std::vector<ImagePair>& lost) {
    std::map<ClusterId, std::vector<ImageId>> lost_ends;
    for (const ImagePair& link : lost) {
        const ClusterId label = state.cluster_of[index_of(link.first)];
        if (state.cluster_of[index_of(link.second)] != label) continue;
        lost_ends[label].push_back(link.first);
        lost_ends[label].push_back(link.second);
    }
    std::vector<ImagePair> held;
    for (const auto& [label, ends] : lost_ends) {
        std::vector<ClusterId> smaller;
        for (const std::vector<ImageId>& part : find_split_parts(state, ends))
            smaller.push_back(relabeller.split_off(part));
        if (smaller.empty()) continue;
        smaller.push_back(label);
        for (const ClusterId part : smaller) {
            const auto links = links_out_of(state, relabeller.images_of(part));
            held.insert(held.end(), links.begin(), links.end());
        }
    }
    join_along(relabeller, graph, held);
}

/// Images of groups that join what they share most with, ascending.
std::vector<ImageId> to_rescue(const ClusteringState& state, const ClusteringOptions& options,
                               const ShownApart& shown) {
    std::vector<ImageId> images = in_small_groups(state.links, options.join_below);
    if (shown.apart.empty()) return images;
    std::erase_if(images, [&](ImageId image) {
        const std::vector<ImageId> group = small_group(state.links, image, options.join_below);
        return makes_model(group.size(), shown.mu_min) &&
               std::ranges::any_of(
                   group, [&](ImageId one) { return !shown.apart[index_of(one)].empty(); });
    });
    return images;
}

/// Rescues the groups that are too small now instead of those that were. @return links that are
/// gone
std::vector<ImagePair> rescue(ClusteringState& state, const ViewGraph& graph,
                              const ClusteringOptions& options, const ShownApart& shown) {
    std::vector<ImageId> before;
    for (std::size_t image = 0; image < state.size(); ++image) {
        if (!state.rescued[image].empty()) before.push_back(static_cast<ImageId>(image));
        state.rescued[image].clear();
    }
    std::vector<ImagePair> lost = update_links(state, graph, before, options).removed;
    if (options.join_below == 0) return lost;
    const std::vector<ImageId> images = to_rescue(state, options, shown);
    for (const ImagePair& pair : rescue_links(state.links, graph, images, options.join_below)) {
        set_rescued(state, pair);
        std::erase(lost, pair);
    }
    return lost;
}

}  // namespace

ClusteringEdit update_clustering(ClusteringState& state, const ViewGraph& graph,
                                 std::span<const ImageId> touched,
                                 const ClusteringOptions& options) {
    assert(graph.size() >= state.size());
    std::vector<ImageId> dirty(touched.begin(), touched.end());
    for (std::size_t image = state.size(); image < graph.size(); ++image) {
        dirty.push_back(static_cast<ImageId>(image));
    }
    sort_unique(dirty);

    state.degrees.resize(graph.size());
    state.links.resize(graph.size());
    state.rescued.resize(graph.size());
    state.workspace.weight.resize(graph.size());
    state.workspace.stamp.resize(graph.size());
    const LinkChanges changes = update_links(state, graph, dirty, options);

    // Joins first: a new image often takes links away whose ends it connects itself, and then the
    // search for parts ends at once.
    Relabeller relabeller(state, graph.size(), options);
    join_along(relabeller, graph, changes.added);
    split_along(relabeller, state, graph, changes.removed);
    return apply_relabelling(state, relabeller.take());
}

ClusteringEdit join_late(ClusteringState& state, const ViewGraph& graph,
                         const ClusteringOptions& options, const ShownApart& shown) {
    assert(graph.size() == state.size());
    ClusteringOptions unheld = options;
    unheld.join_up_to = 0;
    const std::vector<ImagePair> lost = rescue(state, graph, unheld, shown);
    Relabeller relabeller(state, state.size(), unheld);
    for (std::size_t image = 0; image < state.size(); ++image) {
        for (const ImageId other : state.links[image])
            relabeller.join(static_cast<ImageId>(image), other);
    }
    split_along(relabeller, state, graph, lost);
    return apply_relabelling(state, relabeller.take());
}

}  // namespace psfm
