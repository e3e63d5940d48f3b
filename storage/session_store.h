// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "graph/clustering_edit.h"
#include "graph/image.h"
#include "graph/image_source.h"
#include "graph/result.h"
#include "graph/scene.h"
#include "graph/two_view_geometry.h"

namespace psfm {

/// How much of every scene version is kept.
enum class History : std::uint8_t { kNone = 0, kPoses = 1, kFull = 2 };

struct StoreOptions {
    /// Block cache and write buffers together [bytes]. Lower: more reads from disk; higher: more
    /// memory. Ours: descriptors of about 250 images of 8,000 features.
    std::size_t cache_bytes = std::size_t{256} << 20U;
    History history = History::kPoses;
};

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

/// One damaged record found by `check`.
struct DamagedRecord {
    std::string kind;
    std::string key;
    std::string problem;
};

/// What is left of the images of a damaged session.
struct IntactImages {
    std::vector<Image> images;  ///< whose records can be read, ascending by id
    std::uint32_t count = 0;    ///< ids that any record knows of are below
    std::set<ImageId> removed;  ///< of these, what was taken out again
};

/// What `check` saw.
struct CheckReport {
    std::vector<std::pair<std::string, std::uint64_t>> records;  ///< kind, count
    std::vector<DamagedRecord> damaged;
};

/// Read side of a session, shared by the writer and by readers in other processes. Thread-safe.
/// Errors of every call: kDamaged (checksum or grammar), kIo, kNoSpace.
class SessionReader {
  public:
    virtual ~SessionReader() = default;

    virtual Result<SessionSettings> settings() const = 0;
    virtual Result<std::vector<Image>> images() const = 0;  ///< ascending by id
    /// Where they come from, by image id; of removed ones, too.
    virtual Result<std::vector<ImageSource>> image_sources() const = 0;
    virtual Result<std::map<CameraId, Camera>> cameras() const = 0;  ///< as accepted
    virtual Result<std::vector<RejectedPhoto>> rejected() const = 0;
    virtual Result<std::shared_ptr<const Keypoints>> keypoints(ImageId image) const = 0;
    virtual Result<std::shared_ptr<const Descriptors>> descriptors(ImageId image) const = 0;
    /// Images whose pairs are committed are always 0 … n-1. @return n
    virtual Result<std::uint32_t> verified_image_count() const = 0;
    /// Pairs (other, image) with other < image, ascending, as committed together with `image`.
    virtual Result<std::vector<VerifiedPairPtr>> pairs_of(ImageId image) const = 0;
    virtual Result<std::vector<StoredCluster>> clusters() const = 0;
    /// The smallest id that no cluster ever had.
    virtual Result<ClusterId> next_cluster_id() const = 0;
    /// The latest solution of a cluster; nothing when it has none.
    virtual Result<std::optional<StoredSolution>> solution(ClusterId cluster) const = 0;
    /// The model of a certain solution; null when it is not kept any more.
    virtual Result<std::shared_ptr<const Reconstruction>> recycled_model(
        const SolutionReference& solution) const = 0;
    /// The latest scene version, complete with models; version 0 and no clusters for an empty
    /// session.
    virtual Result<Scene> scene() const = 0;
    /// The same without points: models hold poses and cameras only.
    virtual Result<Scene> scene_poses() const = 0;
    virtual Result<std::string> scene_summary_json() const = 0;
    /// The last version with at most `image_count` images. Points are there with History::kFull and
    /// for the latest version; else the models hold poses and cameras only. kNotFound: no such
    /// version is kept.
    virtual Result<Scene> scene_after(std::uint32_t image_count) const = 0;
    /// All versions that are kept, the oldest first. Cost: of all their records, clusters' members
    /// among them, but of no model.
    virtual Result<std::vector<PastVersion>> versions() const = 0;
    /// The images, without those whose records are damaged or missing.
    virtual Result<IntactImages> intact_images() const = 0;
    virtual Result<CheckReport> check(
        const std::function<void(std::uint64_t done)>& progress) const = 0;
    /// Who works with the session keeps so many bytes more in memory, for as long as it is open:
    /// the cache of decoded records becomes smaller by that, down to a quarter. Thread-safe.
    virtual void give_up_cache(std::size_t bytes) const = 0;
    /// Follows the writer (readers in other processes); does nothing in the writer itself.
    virtual Result<void> refresh() = 0;
};

/// The session store: one RocksDB database in one folder, one writing process at a time. Every
/// commit_* is one atomic, synced write: when it returns, it survives a crash of the process and of
/// the machine. The format is written down in FORMAT.md. Thread-safe for reading; commits come from
/// one thread at a time.
class SessionStore : public SessionReader {
  public:
    /// Opens or creates. @errors kInUse (names the holder's pid), kInvalidArgument (the folder is
    /// something else), kVersion, kDamaged, kNoSpace, kIo
    static Result<std::unique_ptr<SessionStore>> open(const std::filesystem::path& folder,
                                                      const StoreOptions& options);
    /// Opens an existing session only. @errors as above; kNotFound
    static Result<std::unique_ptr<SessionStore>> open_existing(const std::filesystem::path& folder,
                                                               const StoreOptions& options);

    /// How much of every version is kept from now on; so far as StoreOptions::history said. kNone
    /// drops all versions but the latest.
    virtual Result<void> keep_history(History history) = 0;
    virtual Result<void> put_settings(const SessionSettings& settings) = 0;
    /// Commit point 1: an image is acknowledged once this returns. `camera` is written when it is
    /// new. REQUIRES: image.id == number of accepted images
    virtual Result<void> commit_image(const Image& image, const Camera& camera,
                                      const Keypoints& keypoints, const Descriptors& descriptors,
                                      const ImageSource& source) = 0;
    /// Of an image that nothing is known of but its pixels.
    Result<void> commit_image(const Image& image, const Camera& camera, const Keypoints& keypoints,
                              const Descriptors& descriptors) {
        return commit_image(image, camera, keypoints, descriptors, ImageSource{});
    }
    virtual Result<void> commit_rejected(const RejectedPhoto& photo) = 0;
    /// Takes images out: their records say so, their descriptors go, and nobody has a pair with
    /// them any more. What was read of descriptors before may still be in the cache. One batch.
    virtual Result<void> commit_removal(const StoredRemoval& removal) = 0;
    /// Photographs that are no longer turned down. One batch.
    virtual Result<void> forget_rejected(const std::vector<std::string>& names) = 0;
    /// Where the files of these images are by now: names, and what is known of the files. All else
    /// is as it was accepted. Rejections of the new names are dropped. One batch.
    virtual Result<void> commit_files(const std::vector<SourcedImage>& images) = 0;
    /// Commit points 2 and 3 in one batch: the pairs of `image` with earlier images, and what they
    /// changed in the clustering (the full records of changed clusters, and the ids of removed
    /// ones). REQUIRES: image.id == verified_image_count()
    virtual Result<void> commit_pairs(ImageId image, const std::vector<VerifiedPairPtr>& pairs,
                                      const std::vector<StoredCluster>& changed,
                                      const std::vector<ClusterId>& removed) = 0;
    /// Commit point 4: a solution, its cluster's record (solved_topology, revision), and what the
    /// solution changed in the clustering: other clusters, or removed ones, its own perhaps. Cost:
    /// of what has changed, where the solution's succession tells.
    virtual Result<void> commit_solution(const StoredSolution& solution,
                                         const StoredCluster& cluster, const StoredEdit& edit) = 0;
    /// The same of a solution that is not kept, since its cluster has changed meanwhile.
    virtual Result<void> commit_clusters(const StoredEdit& edit) = 0;
    /// Commit point 5: a published version, and the full records of clusters that publishing it
    /// changed.
    virtual Result<void> commit_scene(const StoredSceneVersion& version,
                                      const std::vector<StoredCluster>& changed) = 0;
    /// Gives space back that replaced and dropped records still take.
    virtual Result<void> compact() = 0;
};

/// Opens a session for reading beside a busy writer (RocksDB secondary instance).
/// @errors kNotFound, kVersion, kDamaged, kIo
Result<std::unique_ptr<SessionReader>> open_session_reader(const std::filesystem::path& folder,
                                                           const StoreOptions& options);

}  // namespace psfm
