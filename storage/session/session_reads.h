// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "storage/database/read_view.h"
#include "storage/records/scene_records.h"
#include "storage/session/decoded_cache.h"
#include "storage/session/session_store.h"

// Internal: what writer and readers have in common.

namespace psfm {

/// The calls of SessionReader on an open database; see there. Thread-safe.
class SessionReads {
  public:
    /// @param database  outlives this object
    SessionReads(const Database& database, std::size_t decoded_bytes)
        : database_(&database), cache_(decoded_bytes) {}

    Result<SessionSettings> settings() const;
    Result<std::vector<Image>> images() const;
    Result<std::vector<ImageSource>> image_sources() const;
    Result<IntactImages> intact_images() const;
    Result<std::map<CameraId, Camera>> cameras() const;
    Result<std::vector<RejectedPhoto>> rejected() const;
    Result<std::shared_ptr<const Keypoints>> keypoints(ImageId image) const;
    Result<std::shared_ptr<const Descriptors>> descriptors(ImageId image) const;
    Result<std::uint32_t> verified_image_count() const;
    Result<std::vector<VerifiedPairPtr>> pairs_of(ImageId image) const;
    Result<std::vector<StoredCluster>> clusters() const;
    Result<ClusterId> next_cluster_id() const;
    Result<std::optional<StoredSolution>> solution(ClusterId cluster) const;
    Result<std::shared_ptr<const Reconstruction>> recycled_model(
        const SolutionReference& solution) const;
    Result<Scene> scene() const;
    Result<Scene> scene_poses() const;
    Result<std::string> scene_summary_json() const;
    Result<Scene> scene_after(std::uint32_t image_count) const;
    Result<std::vector<PastVersion>> versions() const;
    void give_up_cache(std::size_t bytes) const { cache_.give_up(bytes); }
    void take_back_cache() const { cache_.take_back(); }
    /// Those of an image are others by now. REQUIRES: nobody reads them meanwhile
    void forget_descriptors(ImageId image) const {
        cache_.drop({RecordKind::kDescriptors, index_of(image), 0});
    }

  private:
    enum class WithPoints { kNo, kYes };
    using ModelPtr = std::shared_ptr<const Reconstruction>;

    Result<Scene> latest_scene(WithPoints with_points) const;
    Result<ModelPtr> read_model(const ReadView& view, const SolutionKey& key,
                                WithPoints with_points) const;
    Result<Scene> assemble(const ReadView& view, const SceneRecord& record,
                           WithPoints with_points) const;

    const Database* database_;
    mutable DecodedCache cache_;
};

}  // namespace psfm
