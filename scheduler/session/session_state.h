// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "graph/image.h"
#include "graph/result.h"
#include "graph/scene.h"
#include "graph/view_graph.h"
#include "scheduler/session/cluster_table.h"
#include "scheduler/session/merge_memory.h"
#include "scheduler/session/messages.h"
#include "scheduler/session/resident_keypoints.h"
#include "scheduler/session/resident_models.h"
#include "scheduler/session/session_config.h"
#include "scheduler/session/weak_model.h"
#include "stages/clustering/clustering_state.h"
#include "stages/clustering/select_edges.h"
#include "storage/session/session_store.h"

namespace psfm {

/// An acknowledged image that no published version takes account of yet.
struct PendingImage {
    ImageReport report;
    Clock::time_point arrival;
    bool verified = false;
    bool published = false;
    bool admitted = true;  ///< holds an image token, until it is published at the latest
};

/// The photographs that a session has taken in, and how another one is told from them.
struct TakenPhotographs {
    std::vector<Image> images;                                    ///< by id
    std::vector<ImageSource> sources;                             ///< by id
    ResidentKeypoints keypoints;                                  ///< by id
    std::map<CameraId, Camera> cameras;                           ///< as accepted
    std::map<std::string, CameraId> camera_of_key;                ///< see assign_camera
    std::unordered_map<std::uint64_t, ImageId> image_of_content;  ///< finds byte-identical ones
    std::unordered_set<std::uint64_t> removed_content;            ///< of images taken out
    std::unordered_set<std::string> names;                        ///< of the images
    std::unordered_set<std::string> rejected;  ///< names of photographs, none of an image
    bool is_removed(ImageId image) const {
        return index_of(image) < sources.size() && sources[index_of(image)].removed;
    }
    /// Images of the session, without those that were taken out again.
    std::uint32_t image_count() const {
        const auto removed = std::ranges::count_if(sources, &ImageSource::removed);
        return static_cast<std::uint32_t>(images.size()) - static_cast<std::uint32_t>(removed);
    }
};

/// Everything that a session knows while it runs. Not thread-safe: owned by the commit node.
struct SessionState {
    explicit SessionState(std::uint32_t mu_min) : clusters(mu_min) {}

    TakenPhotographs photographs;
    std::uint32_t verified = 0;  ///< images 0 … verified-1 are nodes of the view graph
    ViewGraph view_graph;
    EdgeSelection edges;  ///< which pairs the view graph holds
    ClusteringState clustering;
    ClusterTable clusters;
    ResidentModels models;  ///< which of the clusters rest
    MergeMemory merges;
    /// No photograph has come since the session was at rest: what is solved looks at weak edges,
    /// and at what it leaves out.
    bool concluding = false;
    ScenePtr scene = std::make_shared<const Scene>();
    SessionCounts counts;
    /// The last joins, splits, transfers and resets, oldest first; at most kPastEvents.
    std::deque<PastEvent> past_events;
    static constexpr std::size_t kPastEvents = 50;  // Guard: bounds what is kept
    std::map<std::uint32_t, PendingImage> pending;  ///< by image index
};

/// Reads a session back: what was committed, and images that were acknowledged but not verified.
struct RestoredSession {
    SessionState state;
    std::vector<AcceptedImagePtr> unverified;  ///< ascending by id
    std::vector<RejectedPhoto> rejected;
    std::vector<std::string> remarks = {};  ///< what was damaged, and is begun anew; for people
};
/// REQUIRES: nobody keeps anything else of the session (SessionReader::take_back_cache)
/// @errors those of the store; kDamaged: its records do not fit each other
Result<RestoredSession> restore_session(const SessionReader& store, const SessionConfig& config,
                                        const StageOptions& options);

/// Memory that verified pairs take for as long as the session is open, about.
std::size_t bytes_of(std::span<const VerifiedPairPtr> pairs);

/// Models that are not to be trusted far, ascending by cluster.
std::vector<WeakModel> weak_models(const SessionState& state);

/// Members of clusters that are in no published model, with the reason, ascending by image.
std::vector<std::pair<ImageId, WaitReason>> waiting_images(const SessionState& state);

}  // namespace psfm
