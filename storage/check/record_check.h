// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "storage/check/check_report.h"
#include "storage/database/read_view.h"
#include "storage/records/cluster_records.h"
#include "storage/records/scene_records.h"

// Internal: one run of SessionReader::check over one view.

namespace psfm {

/// Goes through the families in an order in which records refer to earlier ones only.
class RecordCheck {
  public:
    RecordCheck(const ReadView& view, std::function<void(std::uint64_t)> progress)
        : view_(&view), progress_(std::move(progress)) {}

    CheckReport run();

  private:
    using Visit = void (RecordCheck::*)(std::string_view key, std::string_view value);

    void walk(Family family, Visit visit);
    void check_meta(std::string_view key, std::string_view value);
    void check_image(std::string_view key, std::string_view value);
    void check_keypoints(std::string_view key, std::string_view value);
    void check_descriptors(std::string_view key, std::string_view value);
    void check_pairs(std::string_view key, std::string_view value);
    void check_cluster(std::string_view key, std::string_view value);
    void check_poses(std::string_view key, std::string_view value);
    void check_points(std::string_view key, std::string_view value);
    void check_scene(std::string_view key, std::string_view value);
    void check_completeness();
    void check_clusters_solved();
    void check_latest_scene();

    void count(RecordKind kind);
    void damaged(Family family, std::string_view key, const std::string& problem);
    bool has_feature(ImageId image, std::uint32_t feature) const;

    /// The decoded record, or nothing and an entry in the report.
    template <typename Decode>
    auto decode(Family family, RecordKind kind, std::string_view key, std::string_view value,
                const Decode& decode_payload) {
        count(kind);
        auto payload = open_record(kind, key, value);
        using T = std::remove_cvref_t<decltype(decode_payload(std::string_view{}).value())>;
        std::optional<T> result;
        if (!payload.ok()) {
            damaged(family, key, payload.error().message);
        } else if (auto decoded = decode_payload(*payload); !decoded.ok()) {
            damaged(family, key, decoded.error().message);
        } else {
            result = std::move(*decoded);
        }
        return result;
    }

    const ReadView* view_;
    std::function<void(std::uint64_t)> progress_;
    CheckReport report_;
    std::map<RecordKind, std::uint64_t> counts_;
    std::uint64_t done_ = 0;

    std::set<CameraId> cameras_;
    std::set<ImageId> images_;
    std::map<ImageId, std::size_t> keypoint_counts_;
    std::set<ImageId> with_descriptors_;
    std::set<ImageId> verified_;
    std::map<ClusterId, ClusterRecord> clusters_;
    std::set<SolutionKey> superseded_;
    std::set<SolutionKey> solutions_;
    std::set<SolutionKey> with_points_;
    std::optional<SceneRecord> latest_scene_;
};

}  // namespace psfm
