// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The committer's last step: a merged version becomes the published scene.
#include <algorithm>

#include "scheduler/flow/committer.h"
#include "scheduler/session/encode_state.h"

namespace psfm {

Result<void> Committer::on(const MergedMessage& message, CommitOutput& output) {
    merging_ = false;
    next_version_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                       pace_.rest_per_merge *
                                       std::chrono::duration<double, std::milli>(message.merge_ms));
    if (!message.result->ok()) return message.result->error();
    const MergeResult& merged = message.result->value().merge;
    for (const auto& [id, cameras] : merged.cameras) {
        const auto& clusters = message.problem->clusters;
        const auto cluster = std::ranges::lower_bound(clusters, id, {}, &MergeCluster::id);
        state_.clusters.learn_cameras(id, cluster->model, cameras);
    }
    state_.models.release(state_.clusters);
    auto scene = std::make_shared<Scene>();
    scene->version = state_.scene->version + 1;
    scene->image_count = state_.verified;
    scene->effective_clusters = merged.effective_clusters;
    StoredSceneVersion stored_version;
    for (const MergeCluster& cluster : message.problem->clusters) {
        const auto entry = state_.clusters.entries().find(cluster.id);
        // What has been solved since is shown by the next version, which is due already.
        if (entry == state_.clusters.entries().end()) continue;
        const auto placement =
            std::ranges::lower_bound(merged.placements, cluster.id, {}, &ClusterPlacement::id);
        auto shown = std::make_shared<SceneCluster>();
        shown->id = cluster.id;
        // A cluster that lost its model shows none of its former solutions.
        shown->revision = cluster.model ? cluster.revision : 0;
        shown->members = state_.clusters.images_of(entry->second);
        shown->model = cluster.model;
        if (shown->model && places_others_than(*shown->model, shown->members)) {
            // Images that have left, and guests that have a cluster of their own by now.
            shown->model = std::make_shared<const Reconstruction>(
                restricted_to(*shown->model, shown->members));
        }
        shown->world_from_cluster = placement->world_from_cluster;
        shown->effective_cluster = placement->effective_cluster;
        stored_version.placements.push_back({shown->id, shown->revision, shown->members,
                                             shown->world_from_cluster, shown->effective_cluster});
        scene->clusters.push_back(std::move(shown));
    }
    std::vector<StoredCluster> adopting;
    for (const ClusterId id : keeper_.adopt(message))
        adopting.push_back(keeper_.stored(state_.clusters.entries().at(id)));
    count(*scene);
    state_.scene = scene;  // its summary says of models what holds in it
    stored_version.version = scene->version;
    stored_version.image_count = scene->image_count;
    stored_version.effective_clusters = scene->effective_clusters;
    stored_version.summary_json = encode_summary(
        {state_.counts, waiting_images(state_), state_.past_events, weak_models(state_)});
    if (const auto done = store_->commit_scene(stored_version, adopting); !done.ok())
        return done.error();
    state_.merges.remember(merged);
    PublishMessage publish;
    publish.scene = scene;
    publish.counts = state_.counts;
    reports_.publish(*message.problem, message.merge_ms, publish);
    output.publish = std::move(publish);
    return {};
}

void Committer::count(const Scene& scene) {
    SessionCounts& counts = state_.counts;
    counts.images = state_.photographs.image_count();
    counts.placed = static_cast<std::uint32_t>(placed_count(scene));
    counts.waiting = counts.images - std::min(counts.images, counts.placed);
    counts.rejected = static_cast<std::uint32_t>(state_.photographs.rejected.size());
    counts.clusters =
        static_cast<std::uint32_t>(std::ranges::count_if(scene.clusters, [](const auto& cluster) {
            return cluster->model && !cluster->model->empty();
        }));
    counts.effective_clusters = scene.effective_clusters;
    counts.version = scene.version;
    counts.solves_coalesced = coalesced_before_ + state_.clusters.coalesced();
}

}  // namespace psfm
