// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "storage/check/session_check.h"
#include "storage/session/session_reads.h"

// Internal: the read calls of an interface, answered from one database.

namespace psfm {

/// @tparam Interface  SessionReader or SessionStore
template <typename Interface>
class ReaderOf : public Interface {
  public:
    ReaderOf(std::unique_ptr<Database> database, std::size_t decoded_bytes)
        : database_(std::move(database)), reads_(*database_, decoded_bytes) {}

    Result<SessionSettings> settings() const override { return reads_.settings(); }
    Result<std::vector<Image>> images() const override { return reads_.images(); }
    Result<std::vector<ImageSource>> image_sources() const override {
        return reads_.image_sources();
    }
    Result<std::map<CameraId, Camera>> cameras() const override { return reads_.cameras(); }
    Result<std::vector<RejectedPhoto>> rejected() const override { return reads_.rejected(); }
    Result<std::shared_ptr<const Keypoints>> keypoints(ImageId image) const override {
        return reads_.keypoints(image);
    }
    Result<std::shared_ptr<const Descriptors>> descriptors(ImageId image) const override {
        return reads_.descriptors(image);
    }
    Result<std::uint32_t> verified_image_count() const override {
        return reads_.verified_image_count();
    }
    Result<std::vector<VerifiedPairPtr>> pairs_of(ImageId image) const override {
        return reads_.pairs_of(image);
    }
    Result<std::vector<StoredCluster>> clusters() const override { return reads_.clusters(); }
    Result<ClusterId> next_cluster_id() const override { return reads_.next_cluster_id(); }
    Result<std::shared_ptr<const Reconstruction>> recycled_model(
        const SolutionReference& solution) const override {
        return reads_.recycled_model(solution);
    }
    Result<std::optional<StoredSolution>> solution(ClusterId cluster) const override {
        return reads_.solution(cluster);
    }
    Result<Scene> scene() const override { return reads_.scene(); }
    Result<Scene> scene_poses() const override { return reads_.scene_poses(); }
    Result<std::string> scene_summary_json() const override { return reads_.scene_summary_json(); }
    Result<Scene> scene_after(std::uint32_t image_count) const override {
        return reads_.scene_after(image_count);
    }
    Result<std::vector<PastVersion>> versions() const override { return reads_.versions(); }
    Result<IntactImages> intact_images() const override { return reads_.intact_images(); }
    Result<CheckReport> check(const std::function<void(std::uint64_t)>& progress) const override {
        return check_session(*database_, progress);
    }
    void give_up_cache(std::size_t bytes) const override { reads_.give_up_cache(bytes); }
    void take_back_cache() const override { reads_.take_back_cache(); }
    Result<void> refresh() override {
        const auto followed = database_->catch_up();
        if (!followed.ok()) return followed.error();
        return {};
    }

  protected:
    Database& database() { return *database_; }
    /// See SessionReads.
    void forget_descriptors(ImageId image) const { reads_.forget_descriptors(image); }

  private:
    std::unique_ptr<Database> database_;
    SessionReads reads_;
};

}  // namespace psfm
