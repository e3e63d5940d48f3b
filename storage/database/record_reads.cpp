// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/record_reads.h"

#include <limits>

namespace psfm {
namespace {

Error strange_key(const ReadView& view, Family family, std::string_view key) {
    return view.about(family, key, {ErrorCode::kDamaged, "is under an impossible key"});
}

}  // namespace

Result<std::uint32_t> count_images(const ReadView& view, Family family) {
    const auto last = view.last_key(family);
    if (!last.ok()) return last.error();
    if (!last->has_value()) return std::uint32_t{0};
    const auto image = decode_image_key(**last);
    if (!image) return strange_key(view, family, **last);
    return index_of(*image) + 1;
}

Result<std::map<ClusterId, ClusterRecord>> read_clusters(const ReadView& view) {
    std::map<ClusterId, ClusterRecord> clusters;
    const auto visited = view.for_each(
        Family::kClusters, {}, [&](std::string_view key, std::string_view value) -> Result<void> {
            const auto id = decode_cluster_key(key);
            if (!id) return strange_key(view, Family::kClusters, key);
            auto record = open_and_decode(
                view, Family::kClusters, RecordKind::kCluster, key, value,
                [&](std::string_view payload) { return decode_cluster(*id, payload); });
            if (!record.ok()) return record.error();
            clusters.emplace(*id, std::move(*record));
            return {};
        });
    if (!visited.ok()) return visited.error();
    return clusters;
}

Result<std::set<CameraId>> read_camera_ids(const ReadView& view) {
    std::set<CameraId> ids;
    const auto visited = view.for_each(Family::kMeta, std::string_view(&kCameraTag, 1),
                                       [&](std::string_view key, std::string_view) -> Result<void> {
                                           const auto id = decode_camera_key(key);
                                           if (!id) return strange_key(view, Family::kMeta, key);
                                           ids.insert(*id);
                                           return {};
                                       });
    if (!visited.ok()) return visited.error();
    return ids;
}

Result<SupersededSolutions> read_superseded(const ReadView& view) {
    SupersededSolutions solutions;
    const auto visited = view.for_each(
        Family::kMeta, std::string_view(&kSupersededTag, 1),
        [&](std::string_view key, std::string_view value) -> Result<void> {
            const auto solution = decode_superseded_key(key);
            if (!solution) return strange_key(view, Family::kMeta, key);
            const auto whole = open_and_decode(
                view, Family::kMeta, RecordKind::kSuperseded, key, value,
                [&](std::string_view payload) { return decode_superseded(*solution, payload); });
            if (!whole.ok()) return whole.error();
            solutions.emplace(*solution, *whole);
            return {};
        });
    if (!visited.ok()) return visited.error();
    return solutions;
}

Result<std::optional<SceneRecord>> read_latest_scene(const ReadView& view) {
    return read_scene_after(view, std::numeric_limits<std::uint32_t>::max());
}

Result<std::vector<PastVersion>> read_versions(const ReadView& view) {
    std::vector<PastVersion> versions;
    const auto visited = view.for_each(
        Family::kScenes, {}, [&](std::string_view key, std::string_view value) -> Result<void> {
            const auto scene_key = decode_scene_key(key);
            if (!scene_key) return strange_key(view, Family::kScenes, key);
            auto record = open_and_decode(
                view, Family::kScenes, RecordKind::kScene, key, value,
                [&](std::string_view payload) { return decode_scene(*scene_key, payload); });
            if (!record.ok()) return record.error();
            StoredSceneVersion& scene = record->scene;
            versions.push_back({scene.version, scene.image_count, scene.effective_clusters,
                                std::move(scene.summary_json)});
            return {};
        });
    if (!visited.ok()) return visited.error();
    return versions;
}

Result<std::optional<SceneRecord>> read_scene_after(const ReadView& view,
                                                    std::uint32_t image_count) {
    const SceneKey upper{image_count, std::numeric_limits<std::uint64_t>::max()};
    const auto found = view.at_or_before(Family::kScenes, encode_key(upper));
    if (!found.ok()) return found.error();
    if (!found->has_value()) return std::optional<SceneRecord>();
    const auto& [key, value] = **found;
    const auto scene_key = decode_scene_key(key);
    if (!scene_key) return strange_key(view, Family::kScenes, key);
    auto record = open_and_decode(
        view, Family::kScenes, RecordKind::kScene, key, value,
        [&](std::string_view payload) { return decode_scene(*scene_key, payload); });
    if (!record.ok()) return record.error();
    return std::optional<SceneRecord>(std::move(*record));
}

}  // namespace psfm
