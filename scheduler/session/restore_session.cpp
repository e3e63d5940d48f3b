// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "scheduler/session/encode_state.h"
#include "scheduler/session/session_state.h"
#include "stages/clustering/host_cluster.h"
#include "stages/clustering/keep_apart.h"
#include "stages/features/cameras/assign_camera.h"
#include "stages/merge/values/model_cameras.h"

namespace psfm {
namespace {

Result<void> restore_images(const SessionReader& store, const SessionConfig& config,
                            RestoredSession& restored) {
    SessionState& state = restored.state;
    auto images = store.images();
    if (!images.ok()) return images.error();
    auto cameras = store.cameras();
    if (!cameras.ok()) return cameras.error();
    auto rejected = store.rejected();
    if (!rejected.ok()) return rejected.error();
    const auto verified = store.verified_image_count();
    if (!verified.ok()) return verified.error();
    auto sources = store.image_sources();
    if (!sources.ok()) return sources.error();
    state.photographs.images = *std::move(images);
    state.photographs.sources = *std::move(sources);
    state.photographs.cameras = *std::move(cameras);
    restored.rejected = *std::move(rejected);
    for (const RejectedPhoto& photo : restored.rejected)
        state.photographs.rejected.insert(photo.name);
    state.verified = *verified;
    for (const Image& image : state.photographs.images) {
        std::shared_ptr<const Keypoints> keypoints;
        if (index_of(image.id) >= state.verified) {
            auto read = store.keypoints(image.id);
            if (!read.ok()) return read.error();
            keypoints = *std::move(read);
        }
        state.photographs.keypoints.push_back(std::move(keypoints));
        if (state.photographs.is_removed(image.id)) {
            state.photographs.removed_content.insert(image.metadata.content_hash);
            continue;
        }
        state.photographs.image_of_content.emplace(image.metadata.content_hash, image.id);
        state.photographs.names.insert(image.name);
        // A camera given since then is that of later images only.
        const auto given = config.given_cameras.find(image.name);
        const bool was_given = given != config.given_cameras.end() &&
                               given->second.camera == state.photographs.cameras.at(image.camera);
        const std::string key = was_given
                                    ? "given:" + given->second.key
                                    : camera_key(config.camera_sharing, image.metadata, image.name);
        state.photographs.camera_of_key.emplace(key, image.camera);
    }
    for (std::size_t i = state.verified; i < state.photographs.images.size(); ++i) {
        auto descriptors = store.descriptors(static_cast<ImageId>(i));
        if (!descriptors.ok()) return descriptors.error();
        const Image& image = state.photographs.images[i];
        restored.unverified.push_back(std::make_shared<const AcceptedImage>(
            AcceptedImage{image, state.photographs.cameras.at(image.camera),
                          state.photographs.keypoints[i], *std::move(descriptors)}));
    }
    return {};
}

Result<void> restore_view_graph(const SessionReader& store, const EdgeSelectionOptions& options,
                                SessionState& state) {
    for (std::uint32_t i = 0; i < state.verified; ++i) {
        const auto image = static_cast<ImageId>(i);
        const auto pairs = store.pairs_of(image);
        if (!pairs.ok()) return pairs.error();
        select_edges(state.edges, state.view_graph, image, *pairs, options);
        store.give_up_cache(bytes_of(*pairs));
    }
    const auto clusters = store.clusters();
    if (!clusters.ok()) return clusters.error();
    PlaceVerdict known;
    for (const StoredCluster& cluster : *clusters) {
        for (const ImagePair& pair : cluster.apart) {
            if (index_of(pair.second) >= state.verified)
                return Error{ErrorCode::kDamaged, "cluster " +
                                                      std::to_string(index_of(cluster.id)) +
                                                      " keeps an image apart that has no pairs"};
            known.apart.push_back(pair);
        }
    }
    keep_apart(state.edges, state.view_graph, known);
    return {};
}

/// What the next solve recycles beside the model of a cluster. Where that is damaged the model is
/// good without it, and is adjusted early; people are told.
StoredSolveState solve_state_of(const StoredCluster& stored, const StoredSolution& solution,
                                std::vector<std::string>& remarks) {
    auto state = decode_solve_state(solution.state_json);
    if (state.ok()) return *state;
    remarks.push_back("cluster " + std::to_string(index_of(stored.id)) + ": " +
                      state.error().message + "; its model is kept, and adjusted anew");
    return {};
}

/// What the next solve of a cluster starts from. @param entry  without models
Result<void> restore_models(const SessionReader& store, const StoredCluster& stored,
                            const StageOptions& options, std::vector<std::string>& remarks,
                            ClusterEntry& entry) {
    auto solution = store.solution(stored.id);
    if (!solution.ok()) return solution.error();
    if (solution->has_value() && !stored.abandoned &&
        options.solve.policy.makes_model(entry.membership.members.size())) {
        const StoredSolveState solve_state = solve_state_of(stored, **solution, remarks);
        entry.published.model = (*solution)->model;
        entry.published.settled =
            solve_state.settled && entry.published.topology == entry.membership.topology;
        if (!entry.published.model->empty()) {
            entry.material.models = {{stored.id, stored.revision, entry.published.model}};
            entry.material.state = solve_state.state;
            entry.published.cameras = cameras_of(*entry.published.model);
        }
    }
    if (entry.published.topology >= entry.material.transfer_topology) return {};
    for (const SolutionReference& recycled : stored.recycled) {
        auto model = store.recycled_model(recycled);
        if (!model.ok()) return model.error();
        if (!*model) continue;
        entry.material.models.push_back({recycled.cluster, recycled.revision, *std::move(model)});
        entry.material.brought.emplace_back(recycled.cluster, recycled.revision);
    }
    return {};
}

ClusterEntry without_models(const StoredCluster& stored) {
    ClusterEntry entry;
    entry.id = stored.id;
    entry.membership.members = stored.members;
    entry.membership.topology = stored.topology;
    entry.published.topology = stored.solved_topology;
    entry.published.revision = stored.revision;
    entry.material.transfer_topology = stored.transfer_topology;
    return entry;
}

Result<void> restore_clusters(const SessionReader& store, const StageOptions& options,
                              RestoredSession& restored) {
    SessionState& state = restored.state;
    const auto clusters = store.clusters();
    if (!clusters.ok()) return clusters.error();
    std::vector<ClusterMembers> members;
    std::vector<ClusterEntry> entries;
    ImageHosts hosts;
    for (const StoredCluster& stored : *clusters) {
        members.push_back({stored.id, stored.members});
        entries.push_back(without_models(stored));
        for (const ImageId image : stored.members) hosts.belongs_to(image, stored.id);
    }
    const auto next = store.next_cluster_id();
    if (!next.ok()) return next.error();
    auto clustering = restore_clustering(state.view_graph, members, *next, options.clustering);
    if (!clustering.ok()) return clustering.error();
    state.clustering = *std::move(clustering);
    for (std::uint32_t i = 0; i < state.verified; ++i) {
        const auto image = static_cast<ImageId>(i);
        hosts.set_host(image, host_cluster(state.view_graph, state.clustering, image,
                                           options.solve.policy.mu_min));
    }
    for (const StoredCluster& stored : *clusters) {
        for (const ImageId image : stored.adopted) hosts.adopt(image, stored.id);
    }
    state.clusters =
        ClusterTable(options.solve.policy.mu_min, std::move(entries), std::move(hosts));
    // One model after the other: those of clusters that rest do not stay in memory.
    for (const StoredCluster& stored : *clusters) {
        ClusterEntry models = without_models(stored);
        const auto done = restore_models(store, stored, options, restored.remarks, models);
        if (!done.ok()) return done.error();
        state.clusters.restore_models(std::move(models));
        const ClusterEntry& entry = state.clusters.entries().at(stored.id);
        const bool is_finished =
            entry.phase == ClusterPhase::kClean && is_shown(entry, *state.scene);
        state.concluding |= stored.at_rest && !is_finished;
    }
    return {};
}

}  // namespace

std::size_t bytes_of(std::span<const VerifiedPairPtr> pairs) {
    // Mathematics: either image knows the other, as a plausible neighbor and in the view graph.
    constexpr std::size_t kEdges = 2 * (sizeof(EdgeSelection::Edge) + sizeof(ViewGraph::Edge));
    std::size_t bytes = 0;
    for (const VerifiedPairPtr& pair : pairs)
        bytes +=
            sizeof(VerifiedPair) + kEdges +
            (pair->geometry.inliers.size() + pair->geometry.still.size()) * sizeof(FeatureMatch);
    return bytes;
}

Result<RestoredSession> restore_session(const SessionReader& store, const SessionConfig& config,
                                        const StageOptions& options) {
    RestoredSession restored{SessionState(options.solve.policy.mu_min), {}, {}};
    if (const auto done = restore_images(store, config, restored); !done.ok()) return done.error();
    if (const auto done = restore_view_graph(store, options.edges, restored.state); !done.ok())
        return done.error();
    auto scene = store.scene_poses();
    if (!scene.ok()) return scene.error();
    restored.state.scene = std::make_shared<const Scene>(*std::move(scene));
    if (const auto done = restore_clusters(store, options, restored); !done.ok())
        return done.error();
    const auto summary_text = store.scene_summary_json();
    if (!summary_text.ok()) return summary_text.error();
    const auto summary = decode_summary(*summary_text);
    if (!summary.ok()) return summary.error();
    restored.state.counts = summary->counts;
    restored.state.past_events = summary->events;
    return restored;
}

}  // namespace psfm
