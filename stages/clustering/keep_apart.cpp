// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/keep_apart.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "graph/sorted_unique.h"
#include "stages/clustering/apply_selection.h"
#include "stages/clustering/clustering_options.h"

namespace psfm {
namespace {

void add_sorted(std::vector<ImageId>& images, ImageId image) {
    images.insert(std::ranges::lower_bound(images, image), image);
}

void remove_sorted(std::vector<ImageId>& images, ImageId image) {
    images.erase(std::ranges::lower_bound(images, image));
}

}  // namespace

PlaceVerdict judge_places(const EdgeSelection& selection, std::span<const ImageId> images,
                          std::span<const std::vector<ImageId>> places) {
    const auto position_of = [&](ImageId image) -> std::optional<std::size_t> {
        const auto found = std::ranges::lower_bound(images, image);
        if (found == images.end() || *found != image) return std::nullopt;
        return static_cast<std::size_t>(found - images.begin());
    };
    std::vector<std::uint32_t> place(images.size(), 0);  // from 1; 0: any
    for (std::uint32_t number = 0; number < places.size(); ++number) {
        for (const ImageId image : places[number]) {
            if (const auto position = position_of(image)) place[*position] = number + 1;
        }
    }
    PlaceVerdict verdict;
    for (std::size_t i = 0; i < images.size(); ++i) {
        for (const auto* edges : {&selection.edges, &selection.weak}) {
            for (const EdgeSelection::Edge& edge : (*edges)[index_of(images[i])]) {
                if (edge.neighbor < images[i] || place[i] == 0) continue;
                const auto other = position_of(edge.neighbor);
                if (!other || place[*other] == 0 || place[*other] == place[i]) continue;
                if (!selection.are_apart(images[i], edge.neighbor))
                    verdict.apart.push_back(ImagePair::of(images[i], edge.neighbor));
            }
        }
        for (const ImageId neighbor : selection.apart[index_of(images[i])]) {
            if (neighbor < images[i]) continue;
            const auto other = position_of(neighbor);
            if (other && place[*other] == place[i])
                verdict.together.push_back(ImagePair::of(images[i], neighbor));
        }
    }
    return verdict;
}

std::vector<ImagePair> apart_before(const EdgeSelection& selection, std::span<const ImageId> images,
                                    std::span<const std::vector<ImageId>> places,
                                    std::uint32_t mu_min) {
    std::vector<ImagePair> pairs;
    for (const std::vector<ImageId>& place : places) {
        if (makes_model(place.size(), mu_min)) continue;
        for (const ImageId image : place) {
            for (const ImageId other : selection.apart[index_of(image)]) {
                if (!std::ranges::binary_search(images, other))
                    pairs.push_back(ImagePair::of(image, other));
            }
        }
    }
    sort_unique(pairs);
    return pairs;
}

EdgeChanges keep_apart(EdgeSelection& selection, ViewGraph& graph, const PlaceVerdict& verdict) {
    for (const auto& [a, b] : verdict.apart) {
        add_sorted(selection.apart[index_of(a)], b);
        add_sorted(selection.apart[index_of(b)], a);
    }
    for (const auto& [a, b] : verdict.together) {
        remove_sorted(selection.apart[index_of(a)], b);
        remove_sorted(selection.apart[index_of(b)], a);
    }
    selection.apart_count += verdict.apart.size();
    selection.apart_count -= verdict.together.size();
    std::set<ImagePair> pairs(verdict.apart.begin(), verdict.apart.end());
    pairs.insert(verdict.together.begin(), verdict.together.end());
    std::set<ImageId> recount;
    for (const auto& [a, b] : pairs) {
        for (const ImageId image : {a, b}) {
            recount.insert(image);
            for (const EdgeSelection::Edge& edge : selection.edges[index_of(image)])
                recount.insert(edge.neighbor);
        }
    }
    // What was opposed may not be any more, also where nothing is apart now.
    for (const ImageId image : recount) {
        for (const EdgeSelection::Edge& edge : selection.weak[index_of(image)])
            pairs.insert(ImagePair::of(image, edge.neighbor));
    }
    return apply_selection(selection, graph, recount, std::move(pairs));
}

std::vector<ImagePair> apart_pairs_of(const EdgeSelection& selection,
                                      std::span<const ImageId> images) {
    std::vector<ImagePair> pairs;
    if (selection.apart_count == 0) return pairs;
    for (const ImageId image : images) {
        for (const ImageId other : selection.apart[index_of(image)]) {
            if (image < other) pairs.push_back({image, other});
        }
    }
    return pairs;
}

bool hang_together(const ClusteringState& clustering, const EdgeSelection& selection, ClusterId a,
                   ClusterId b, double min_relative) {
    const auto matches = [](const EdgeSelection::Edge& edge) {
        return static_cast<double>(edge.pair->geometry.inliers.size());
    };
    const auto most_matches = [&](ImageId image) {
        double most = 0.0;
        for (const EdgeSelection::Edge& edge : selection.edges[index_of(image)])
            most = std::max(most, matches(edge));
        return most;
    };
    return std::ranges::any_of(clustering.members.at(a), [&](ImageId image) {
        const double most = most_matches(image);
        return std::ranges::any_of(
            selection.edges[index_of(image)], [&](const EdgeSelection::Edge& edge) {
                return clustering.cluster_of[index_of(edge.neighbor)] == b &&
                       matches(edge) >= min_relative * std::min(most, most_matches(edge.neighbor));
            });
    });
}

std::vector<std::vector<ImageId>> images_held_apart(const ClusteringState& clustering,
                                                    const EdgeSelection& selection) {
    std::map<ClusterId, std::set<ClusterId>> neighbors;
    for (std::uint32_t image = 0; image < selection.apart.size(); ++image) {
        for (const ImageId other : selection.apart[image])
            neighbors[clustering.cluster_of[image]].insert(clustering.cluster_of[index_of(other)]);
    }
    std::vector<std::vector<ImageId>> groups;
    std::set<ClusterId> reached;
    for (const auto& [cluster, beside] : neighbors) {
        std::vector<ClusterId> open;
        std::vector<ImageId> images;
        if (reached.insert(cluster).second) open.push_back(cluster);
        while (!open.empty()) {
            const ClusterId next = open.back();
            open.pop_back();
            const std::vector<ImageId>& members = clustering.members.at(next);
            images.insert(images.end(), members.begin(), members.end());
            for (const ClusterId other : neighbors[next]) {
                if (reached.insert(other).second) open.push_back(other);
            }
        }
        if (images.empty()) continue;
        std::ranges::sort(images);
        groups.push_back(std::move(images));
    }
    return groups;
}

}  // namespace psfm
