// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/remove_images.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "scheduler/session/encode_state.h"
#include "scheduler/session/file_stamp.h"
#include "scheduler/session/session_state.h"
#include "stages/clustering/keep_apart.h"
#include "stages/clustering/select_edges.h"
#include "stages/clustering/update_clustering.h"

namespace psfm {
namespace {

using Images = std::set<ImageId>;

/// The view graph of a session without some of its images.
struct GraphWithout {
    EdgeSelection edges;
    ViewGraph graph;
    /// The lists of pairs that are shorter now.
    std::map<ImageId, std::vector<VerifiedPairPtr>> shortened;
};

Result<GraphWithout> graph_without(const SessionReader& store, const SessionState& state,
                                   const StageOptions& options, const Images& removed) {
    GraphWithout without;
    for (std::uint32_t i = 0; i < state.verified; ++i) {
        const auto image = static_cast<ImageId>(i);
        auto pairs = store.pairs_of(image);
        if (!pairs.ok()) return pairs.error();
        const std::size_t before = pairs->size();
        std::erase_if(*pairs, [&](const VerifiedPairPtr& pair) {
            return removed.contains(pair->pair.first) || removed.contains(pair->pair.second);
        });
        select_edges(without.edges, without.graph, image, *pairs, options.edges);
        if (pairs->size() != before) without.shortened.emplace(image, *std::move(pairs));
    }
    PlaceVerdict known;
    for (std::uint32_t i = 0; i < state.verified; ++i) {
        const auto image = static_cast<ImageId>(i);
        if (removed.contains(image)) continue;
        for (const ImageId other : state.edges.apart[i]) {
            if (image < other && !removed.contains(other)) known.apart.push_back({image, other});
        }
    }
    keep_apart(without.edges, without.graph, known);
    return without;
}

/// Images whose edges differ.
std::vector<ImageId> changed_images(const ViewGraph& before, const ViewGraph& after) {
    const auto same = [](const ViewGraph::Edge& a, const ViewGraph::Edge& b) {
        return a.neighbor == b.neighbor && a.weight == b.weight;
    };
    std::vector<ImageId> changed;
    for (std::uint32_t i = 0; i < after.size(); ++i) {
        const auto image = static_cast<ImageId>(i);
        if (!std::ranges::equal(before.edges(image), after.edges(image), same))
            changed.push_back(image);
    }
    return changed;
}

/// Whether removed images take part in a cluster: as members, guests, or in what it has been or
/// will be solved from.
bool rests_on(const ClusterEntry& entry, std::span<const ImageId> guests, const Images& removed) {
    const auto is_removed = [&](ImageId image) { return removed.contains(image); };
    const auto holds = [&](const std::shared_ptr<const Reconstruction>& model) {
        return model && std::ranges::any_of(model->images, [&](const RegisteredImage& image) {
                   return is_removed(image.image);
               });
    };
    return std::ranges::any_of(entry.membership.members, is_removed) ||
           std::ranges::any_of(guests, is_removed) || holds(entry.published.model) ||
           std::ranges::any_of(entry.material.models,
                               [&](const RecycledModel& m) { return holds(m.model); });
}

struct Reclustering {
    StoredEdit edit;
    std::size_t anew = 0;  ///< clusters of mu_min images and more without a model
};

/// Clusters of the graph without the images. @param state  its clustering is brought up to date
Result<Reclustering> recluster(SessionState& state, const GraphWithout& without,
                               const StageOptions& options, const Images& removed,
                               const std::vector<StoredCluster>& stored) {
    std::set<ClusterId> gone;
    for (const auto& [id, entry] : state.clusters.entries()) {
        if (rests_on(entry, state.clusters.hosts().guests_of(id), removed)) gone.insert(id);
    }
    const std::vector<ClusterId> cluster_before = state.clustering.cluster_of;
    const ClusteringEdit edit =
        update_clustering(state.clustering, without.graph,
                          changed_images(state.view_graph, without.graph), options.clustering);
    for (const ClusterMembers& changed : edit.changed) gone.insert(changed.id);
    gone.insert(edit.removed.begin(), edit.removed.end());
    Reclustering result;
    std::map<ClusterId, const StoredCluster*> live;
    for (const StoredCluster& cluster : stored) live.emplace(cluster.id, &cluster);
    ClusterId next = state.clustering.next_id;
    for (const auto& [id, members] : state.clustering.members) {
        const bool is_new = gone.contains(id) || !live.contains(id) ||
                            std::ranges::any_of(members, [&](ImageId image) {
                                return gone.contains(cluster_before[index_of(image)]);
                            });
        std::vector<ImagePair> apart = apart_pairs_of(without.edges, members);
        if (!is_new) {
            if (apart == live.at(id)->apart) continue;
            result.edit.changed.push_back(*live.at(id));
            result.edit.changed.back().apart = std::move(apart);
            continue;
        }
        StoredCluster cluster;
        cluster.id = next;
        next = static_cast<ClusterId>(index_of(next) + 1);
        cluster.members = members;
        cluster.topology = 1;
        cluster.apart = std::move(apart);
        if (options.solve.policy.makes_model(members.size())) ++result.anew;
        if (live.contains(id)) gone.insert(id);
        result.edit.changed.push_back(std::move(cluster));
    }
    for (const ClusterId id : gone) {
        if (live.contains(id)) result.edit.removed.push_back(id);
    }
    std::ranges::sort(result.edit.changed, {}, &StoredCluster::id);
    return result;
}

/// The latest version without the images; its poses stay those of its solutions.
Result<void> publish_without(SessionStore& store, const Images& removed, bool keep_out) {
    const auto scene = store.scene_poses();
    if (!scene.ok()) return scene.error();
    if (scene->version == 0) return {};
    const auto text = store.scene_summary_json();
    if (!text.ok()) return text.error();
    auto summary = decode_summary(*text);
    if (!summary.ok()) return summary.error();
    const auto is_removed = [&](ImageId image) { return removed.contains(image); };
    StoredSceneVersion version;
    version.version = scene->version + 1;
    version.image_count = scene->image_count;
    version.effective_clusters = scene->effective_clusters;
    std::uint32_t placed = 0;
    for (const auto& cluster : scene->clusters) {
        std::vector<ImageId> members = cluster->members;
        std::erase_if(members, is_removed);
        if (cluster->model) {
            placed += static_cast<std::uint32_t>(std::ranges::count_if(
                cluster->model->images, [&](const auto& i) { return !is_removed(i.image); }));
        }
        if (members.empty()) continue;
        version.placements.push_back({cluster->id, cluster->revision, std::move(members),
                                      cluster->world_from_cluster, cluster->effective_cluster});
    }
    SessionCounts& counts = (*summary).counts;
    counts.version = version.version;
    counts.placed = placed;
    counts.images -= std::min(counts.images, static_cast<std::uint32_t>(removed.size()));
    if (keep_out) counts.rejected += static_cast<std::uint32_t>(removed.size());
    counts.waiting = counts.images - std::min(counts.images, placed);
    std::erase_if((*summary).waiting, [&](const auto& entry) { return is_removed(entry.first); });
    version.summary_json = encode_summary(*summary);
    return store.commit_scene(version, {});
}

}  // namespace

std::string removal_reason(const std::string& name) {
    return name + ": was taken out with 'psfm remove', which '--undo' takes back";
}

Result<Removal> remove_images(SessionStore& store, const SessionConfig& config,
                              std::span<const ImageId> images, bool keep_out) {
    const auto options = stage_options(config);
    if (!options.ok()) return options.error();
    auto restored = restore_session(store, config, *options);
    if (!restored.ok()) return restored.error();
    SessionState& state = (*restored).state;
    const Images removed(images.begin(), images.end());
    const auto without = graph_without(store, state, *options, removed);
    if (!without.ok()) return without.error();
    const auto stored = store.clusters();
    if (!stored.ok()) return stored.error();
    auto clusters = recluster(state, *without, *options, removed, *stored);
    if (!clusters.ok()) return clusters.error();

    StoredRemoval removal;
    removal.edit = std::move(clusters->edit);
    removal.pairs = without->shortened;
    for (const ImageId id : removed) {
        SourcedImage image{state.photographs.images[index_of(id)],
                           state.photographs.sources[index_of(id)]};
        const ImageFile& file = image.source.file;
        if (keep_out) {
            removal.rejected.push_back({image.image.name, removal_reason(image.image.name),
                                        image.image.metadata.content_hash, file.size,
                                        file.modified_ns});
        } else {
            image.image.metadata.content_hash = 0;
        }
        image.source.removed = true;
        image.source.signature.clear();
        image.image.metadata.gps.reset();
        removal.images.push_back(std::move(image));
    }
    if (const auto done = store.commit_removal(removal); !done.ok()) return done.error();
    if (const auto done = publish_without(store, removed, keep_out); !done.ok())
        return done.error();
    return Removal{clusters->anew};
}

}  // namespace psfm
