// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "graph/clustering_edit.h"
#include "graph/image.h"
#include "graph/image_source.h"
#include "graph/reconstruction.h"
#include "graph/scene.h"
#include "graph/two_view_geometry.h"

namespace psfm {

/// Settings that a session was made with. They are stored with it, and hold for every later `run`
/// and `resume`, so that a resumed session ends as it would have ended.
struct SessionSettings {
    std::string photo_folder;  ///< absolute
    std::string
        settings_json;  ///< the options of `run` that shape results, as written by the scheduler
};

/// An image with what is known of its file.
struct SourcedImage {
    Image image;
    ImageSource source;
};

/// A photograph that was looked at and turned down.
struct RejectedPhoto {
    std::string name;
    std::string reason;              ///< one line for people: what is wrong and what to do
    std::uint64_t content_hash = 0;  ///< 0 when the file could not be read
    /// Of the file that was looked at; a changed one is looked at again.
    std::int64_t file_size = 0;  ///< [bytes]; -1: looked at again, even if it has not changed
    std::int64_t file_time = 0;  ///< when it was written, by its file system [ns]; 0: not known
};

/// A solution of a cluster, by number.
struct SolutionReference {
    ClusterId cluster{};
    std::uint32_t revision = 0;
    auto operator<=>(const SolutionReference&) const = default;
};

/// One cluster as stored: membership, and the solution that belongs to it.
struct StoredCluster {
    ClusterId id{};
    std::vector<ImageId> members;
    std::uint32_t topology = 0;  ///< counts changes of membership, from 1
    std::uint32_t solved_topology =
        0;  ///< topology that the last solution was made for; dirty when it differs
    std::uint32_t revision = 0;  ///< counts solutions, from 1; 0: none yet
    /// When images last brought models along; what the cluster's solutions for earlier topologies
    /// do not hold.
    std::uint32_t transfer_topology = 0;
    /// Solutions of other clusters whose parts came along, and that the next solve joins. Kept as
    /// long as solved_topology is below transfer_topology.
    std::vector<SolutionReference> recycled;
    /// Members of other clusters that could not be placed there and are tried against this one,
    /// ascending.
    std::vector<ImageId> adopted;
    /// Pairs of images that are of different places (keep_apart), the first of them a member;
    /// ascending.
    std::vector<ImagePair> apart = {};
    /// Too few images of the latest solution stayed together: it is shown no more, and no later
    /// solve starts from it, also where they come together again.
    bool abandoned = false;
    /// It changed, or was solved, last when no photograph followed (SessionState::concluding).
    bool at_rest = false;
};

/// What an edit of the clustering leaves to be stored.
struct StoredEdit {
    std::vector<StoredCluster> changed;  ///< full records, ascending by id
    std::vector<ClusterId> removed;      ///< ascending
};

/// A solution of one cluster, as the solve stage left it.
struct StoredSolution {
    ClusterId cluster{};
    std::uint32_t revision = 0;
    std::shared_ptr<const Reconstruction> model;
    std::string state_json;  ///< what the next solve recycles beside the model (sizes at the last
                             ///< full adjustment, …)
    /// Of the model from the one before. Where that is what the store has of the cluster, only what
    /// has changed is written; never given back.
    std::optional<Succession> succession = {};
};

/// Where one cluster stands in a scene version; its poses are those of solution (cluster,
/// revision).
struct StoredPlacement {
    ClusterId cluster{};
    std::uint32_t revision = 0;
    std::vector<ImageId> members;
    Sim3 world_from_cluster;
    std::uint32_t effective_cluster = 0;
};

struct StoredSceneVersion {
    std::uint64_t version = 0;
    std::uint32_t image_count = 0;
    std::uint32_t effective_clusters = 0;
    std::vector<StoredPlacement> placements;  ///< ascending by cluster
    std::string summary_json;  ///< counts shown by `status` (resets, waiting by reason, …)
};

/// What a kept version says of itself, without its clusters.
struct PastVersion {
    std::uint64_t version = 0;
    std::uint32_t image_count = 0;
    std::uint32_t effective_clusters = 0;
    std::string summary_json;
};

/// What is left of a session that images are taken out of.
struct StoredRemoval {
    /// The removed ones, as they stay: their ids are never used again, and old versions show them.
    std::vector<SourcedImage> images;
    /// Lists of pairs that named one of them, without those; by image, of verified ones.
    std::map<ImageId, std::vector<VerifiedPairPtr>> pairs;
    StoredEdit edit;
    /// The same photographs as ones that are turned down, so that they stay out.
    std::vector<RejectedPhoto> rejected;
};

/// What is left of the images of a damaged session.
struct IntactImages {
    std::vector<Image> images;         ///< whose records can be read, ascending by id
    std::vector<ImageSource> sources;  ///< beside them
    std::uint32_t count = 0;           ///< ids that any record knows of are below
    std::set<ImageId> removed;         ///< of these, what was taken out again
};

}  // namespace psfm
