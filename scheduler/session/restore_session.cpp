// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <span>
#include <string>

#include "scheduler/session/encode_state.h"
#include "scheduler/session/session_state.h"
#include "stages/clustering/host_cluster.h"
#include "stages/clustering/keep_apart.h"
#include "stages/features/cameras/assign_camera.h"
#include "stages/merge/values/model_cameras.h"
#include "storage/database/system_error.h"

namespace psfm {
namespace {

/// What the records say of each other does not fit, though each of them is sound.
Error mismatch_in(const std::string& record, const std::string& problem) {
    return {ErrorCode::kDamaged, record + " " + problem + kDamageRemedy};
}

std::string label(ImageId image) {
    return "image " + std::to_string(index_of(image));
}
std::string label(ClusterId cluster) {
    return "cluster " + std::to_string(index_of(cluster));
}

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
    if (state.verified > state.photographs.images.size())
        return mismatch_in(label(ImageId{state.verified - 1}), "has pairs, and is missing");
    for (const Image& image : state.photographs.images) {
        if (!state.photographs.cameras.contains(image.camera))
            return mismatch_in(label(image.id), "has a camera that is missing");
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

void expect_features(std::span<const VerifiedPairPtr> pairs, ResidentKeypoints& keypoints) {
    for (const VerifiedPairPtr& pair : pairs) {
        for (const FeatureMatch& match : pair->geometry.inliers) {
            keypoints.expect(pair->pair.first, match.first);
            keypoints.expect(pair->pair.second, match.second);
        }
    }
}

/// @errors kDamaged: the model names an image that is not there
Result<void> expect_features(const Reconstruction& model, ClusterId cluster,
                             ResidentKeypoints& keypoints) {
    for (const RegisteredImage& image : model.images) {
        if (index_of(image.image) >= keypoints.size())
            return mismatch_in(label(cluster), "has a model of an image that is missing");
    }
    for (const ScenePoint& point : model.points) {
        for (const Observation& observation : point.track)
            keypoints.expect(observation.image, observation.feature);
    }
    return {};
}

/// Whether all of these are nodes of the view graph. @param images  ascending
bool are_verified(std::span<const ImageId> images, const SessionState& state) {
    return images.empty() || index_of(images.back()) < state.verified;
}

Result<void> restore_view_graph(const SessionReader& store, const EdgeSelectionOptions& options,
                                SessionState& state) {
    for (std::uint32_t i = 0; i < state.verified; ++i) {
        const auto image = static_cast<ImageId>(i);
        const auto pairs = store.pairs_of(image);
        if (!pairs.ok()) return pairs.error();
        expect_features(*pairs, state.photographs.keypoints);
        select_edges(state.edges, state.view_graph, image, *pairs, options);
        store.give_up_cache(bytes_of(*pairs));
    }
    const auto clusters = store.clusters();
    if (!clusters.ok()) return clusters.error();
    PlaceVerdict known;
    for (const StoredCluster& cluster : *clusters) {
        if (!are_verified(cluster.members, state))
            return mismatch_in(label(cluster.id), "has a member that has no pairs");
        if (!are_verified(cluster.adopted, state))
            return mismatch_in(label(cluster.id), "has adopted an image that has no pairs");
        for (const ImagePair& pair : cluster.apart) {
            if (index_of(pair.second) >= state.verified)
                return mismatch_in(label(cluster.id), "keeps an image apart that has no pairs");
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
    remarks.push_back(label(stored.id) + ": " + state.error().message +
                      "; its model is kept, and adjusted anew");
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
        for (const RecycledModel& recycled : models.material.models) {
            const auto named =
                expect_features(*recycled.model, stored.id, state.photographs.keypoints);
            if (!named.ok()) return named.error();
        }
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
    store.take_back_cache();  // of what was restored before
    if (const auto done = restore_images(store, config, restored); !done.ok()) return done.error();
    if (const auto done = restore_view_graph(store, options.edges, restored.state); !done.ok())
        return done.error();
    auto scene = store.scene_poses();
    if (!scene.ok()) return scene.error();
    if (scene->image_count > restored.state.photographs.images.size())
        return mismatch_in("the latest version", "knows of more images than there are");
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
