// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graph/image.h"
#include "graph/image_source.h"
#include "graph/result.h"
#include "graph/scene.h"
#include "graph/two_view_geometry.h"
#include "storage/check/check_report.h"
#include "storage/database/store_options.h"
#include "storage/records/stored_values.h"

namespace psfm {

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
    /// Who works with the session keeps so many bytes more in memory: the cache of decoded records
    /// becomes smaller by that, down to a quarter. Thread-safe.
    virtual void give_up_cache(std::size_t bytes) const = 0;
    /// Nobody keeps any of that any more: the cache is as large as at first. Thread-safe.
    virtual void take_back_cache() const = 0;
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
    /// them any more. One batch. REQUIRES: nobody reads these descriptors meanwhile
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
