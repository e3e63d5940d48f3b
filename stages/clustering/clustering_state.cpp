// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/clustering_state.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "stages/clustering/rescue_links.h"
#include "stages/clustering/update_links.h"

namespace psfm {
namespace {

Error mismatch(const std::string& what) {
    return {ErrorCode::kInvalidArgument,
            "clustering: stored clusters do not belong to this view graph and these options (" +
                what + "); use the options that the session was made with, or cluster anew"};
}

/// Links join all images of a cluster, and none of two that may join.
bool are_components(const ClusteringState& state, const ClusteringOptions& options) {
    std::vector<bool> seen(state.size(), false);
    for (const auto& [id, members] : state.members) {
        std::vector<ImageId> found{members.front()};
        seen[index_of(members.front())] = true;
        for (std::size_t at = 0; at < found.size(); ++at) {
            for (const ImageId next : state.links[index_of(found[at])]) {
                if (const ClusterId other = state.cluster_of[index_of(next)]; other != id) {
                    if (may_join(members.size(), state.members.at(other).size(), options))
                        return false;
                    continue;
                }
                if (seen[index_of(next)]) continue;
                seen[index_of(next)] = true;
                found.push_back(next);
            }
        }
        if (found.size() != members.size()) return false;
    }
    return true;
}

/// Joins the parts of a cluster that no distance joins, by the strongest edges between them.
void rescue_again(ClusteringState& state, const ViewGraph& graph,
                  const std::vector<ImageId>& members) {
    const auto everywhere = static_cast<std::uint32_t>(members.size());
    if (small_group(state.links, members.front(), everywhere).size() == members.size()) return;
    for (const ImagePair& pair : links_within(state.links, graph, members))
        set_rescued(state, pair);
}

}  // namespace

std::vector<ClusterMembers> clusters_of(const ClusteringState& state) {
    std::vector<ClusterMembers> clusters;
    clusters.reserve(state.members.size());
    for (const auto& [id, members] : state.members) clusters.push_back({id, members});
    return clusters;
}

Result<ClusteringState> restore_clustering(const ViewGraph& graph,
                                           std::span<const ClusterMembers> clusters,
                                           ClusterId next_id, const ClusteringOptions& options) {
    if (auto valid = validate(options); !valid.ok()) return valid.error();
    ClusteringState state;
    state.next_id = next_id;
    state.cluster_of.assign(graph.size(), next_id);
    std::size_t placed = 0;
    for (const ClusterMembers& cluster : clusters) {
        const std::string name = "cluster " + std::to_string(index_of(cluster.id));
        if (cluster.id >= next_id) return mismatch(name + " is not below the next free id");
        if (cluster.members.empty()) return mismatch(name + " is empty");
        if (!std::ranges::is_sorted(cluster.members)) return mismatch(name + " is not sorted");
        if (!state.members.emplace(cluster.id, cluster.members).second) {
            return mismatch(name + " is listed twice");
        }
        for (const ImageId image : cluster.members) {
            if (index_of(image) >= graph.size()) return mismatch(name + " has an unknown image");
            if (state.cluster_of[index_of(image)] != next_id) {
                return mismatch("image " + std::to_string(index_of(image)) + " is in two clusters");
            }
            state.cluster_of[index_of(image)] = cluster.id;
            ++placed;
        }
    }
    if (placed != graph.size()) return mismatch("an image is in no cluster");

    state.degrees.resize(graph.size());
    state.links.resize(graph.size());
    state.rescued.resize(graph.size());
    state.workspace.weight.resize(graph.size());
    state.workspace.stamp.resize(graph.size());
    std::vector<ImageId> all(graph.size());
    for (std::uint32_t i = 0; i < graph.size(); ++i) all[i] = static_cast<ImageId>(i);
    update_links(state, graph, all, options);
    for (const auto& [id, members] : state.members) rescue_again(state, graph, members);
    if (!are_components(state, options)) return mismatch("other images are linked");
    return state;
}

}  // namespace psfm
