// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>

#include "scheduler/session/session_state.h"

namespace psfm {
namespace {

/// Inliers of an image's edges, and those of mere turns among them.
struct Turns {
    double turns = 0.0;
    double all = 0.0;

    void add(const ViewGraph& graph, ImageId image) {
        for (const ViewGraph::Edge& edge : graph.edges(image)) {
            all += edge.weight;
            if (edge.pair && edge.pair->geometry.kind == TwoViewKind::kPureRotation)
                turns += edge.weight;
        }
    }
    bool prevail() const {
        constexpr double kHalf = 0.5;  // Mathematics: the majority; it only words why images wait
        return turns > kHalf * all;
    }
};

/// Why an image waits that has no edge.
WaitReason reason_without_edges(const EdgeSelection& selection, ImageId image) {
    // Pairs that are plausible and no edges rest on what stands still, or are of another place.
    const bool rests_on_still =
        !selection.still[index_of(image)].empty() && !selection.edges[index_of(image)].empty();
    return selection.still_only[index_of(image)] > 0 || rests_on_still ? WaitReason::kStandsStill
                                                                       : WaitReason::kTooFewMatches;
}

/// Whether an image is kept apart from one that it has a plausible pair with.
bool is_kept_apart(const SessionState& state, ImageId image) {
    return index_of(image) < state.edges.apart.size() &&
           !state.edges.apart[index_of(image)].empty();
}

/// The connected part that each cluster with a model stands in.
std::map<ClusterId, std::uint32_t> parts_of(const Scene& scene) {
    std::map<ClusterId, std::uint32_t> parts;
    for (const auto& cluster : scene.clusters) {
        if (cluster->model && !cluster->model->empty())
            parts.emplace(cluster->id, cluster->effective_cluster);
    }
    return parts;
}

/// Whether images of a cluster were kept apart from some that are not in its part.
bool has_a_look_alike(const SessionState& state, const std::vector<ImageId>& members,
                      std::uint32_t part, const std::map<ClusterId, std::uint32_t>& parts) {
    return std::ranges::any_of(members, [&](ImageId image) {
        if (!is_kept_apart(state, image)) return false;
        return std::ranges::any_of(state.edges.apart[index_of(image)], [&](ImageId other) {
            const auto found = parts.find(state.clustering.cluster_of[index_of(other)]);
            return !state.photographs.is_removed(other) &&
                   (found == parts.end() || found->second != part);
        });
    });
}

}  // namespace

std::vector<WeakModel> weak_models(const SessionState& state) {
    std::vector<WeakModel> weak;
    const auto parts = parts_of(*state.scene);
    for (const auto& [id, entry] : state.clusters.entries()) {
        if (!entry.published.model || entry.published.model->empty()) continue;
        Weaknesses weaknesses = entry.material.state.weaknesses;
        const auto part = parts.find(id);
        if (part != parts.end() &&
            has_a_look_alike(state, entry.membership.members, part->second, parts))
            weaknesses.add(Weakness::kLookAlikes);
        if (weaknesses.none()) continue;
        weak.push_back(
            {id, static_cast<std::uint32_t>(entry.published.model->images.size()), weaknesses});
    }
    return weak;
}

std::vector<std::pair<ImageId, WaitReason>> waiting_images(const SessionState& state) {
    std::vector<std::pair<ImageId, WaitReason>> waiting;
    for (const auto& [id, entry] : state.clusters.entries()) {
        const bool has_no_model =
            is_solved(entry) && (!entry.published.model || entry.published.model->empty());
        Turns of_cluster;
        if (has_no_model) {
            for (const ImageId image : entry.membership.members)
                of_cluster.add(state.view_graph, image);
        }
        for (const ImageId image : state.clusters.unplaced_of(entry)) {
            if (state.photographs.is_removed(image)) continue;
            WaitReason reason = WaitReason::kSolving;
            if (state.view_graph.edges(image).empty()) {
                reason = is_kept_apart(state, image) ? WaitReason::kLookAlikes
                                                     : reason_without_edges(state.edges, image);
            } else if (has_no_model && of_cluster.prevail()) {
                reason = WaitReason::kNoParallax;
            } else if (!state.clusters.makes_model(entry.membership.members.size())) {
                reason = is_kept_apart(state, image) ? WaitReason::kLookAlikes
                                                     : WaitReason::kClusterTooSmall;
            } else if (is_solved(entry)) {
                reason = has_no_model ? WaitReason::kNoSeed : WaitReason::kRegistrationFailed;
            }
            waiting.emplace_back(image, reason);
        }
    }
    for (std::uint32_t image = state.verified; image < state.photographs.images.size(); ++image) {
        const auto id = static_cast<ImageId>(image);
        if (!state.photographs.is_removed(id)) waiting.emplace_back(id, WaitReason::kSolving);
    }
    std::ranges::sort(waiting);
    return waiting;
}

}  // namespace psfm
