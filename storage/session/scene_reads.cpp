// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>

#include "storage/database/record_reads.h"
#include "storage/database/solution_chain.h"
#include "storage/session/session_reads.h"

namespace psfm {
namespace {

std::size_t bytes_of(const Reconstruction& model) {
    std::size_t bytes = sizeof(Reconstruction) + model.images.size() * sizeof(RegisteredImage) +
                        model.cameras.size() * (sizeof(Camera) + 64);
    for (const ScenePoint& point : model.points) {
        bytes += sizeof(ScenePoint) + point.track.size() * sizeof(Observation);
    }
    return bytes;
}

Error missing(const ReadView& view, Family family, const SolutionKey& key) {
    return view.about(family, encode_key(key), {ErrorCode::kDamaged, "is missing"});
}

struct WholeSolution {
    Reconstruction model;
    std::string state_json;
};

/// Poses and points put together; nothing when the points were dropped, alone or with the poses.
Result<std::optional<WholeSolution>> read_whole(const ReadView& view, const SolutionKey& key) {
    auto points = read_points(view, key);
    if (!points.ok()) return points.error();
    if (!points->has_value()) return std::optional<WholeSolution>();
    auto poses = read_poses(view, key);
    if (!poses.ok()) return poses.error();
    if (!poses->has_value()) return missing(view, Family::kSolutions, key);
    if (!points_belong_to((*points)->points, **poses)) {
        return view.about(Family::kPoints, encode_key(key),
                          {ErrorCode::kDamaged, "a point observes an image that has no pose"});
    }
    WholeSolution whole{std::move(**poses), std::move((*points)->state_json)};
    whole.model.points = std::move((*points)->points);
    return std::optional<WholeSolution>(std::move(whole));
}

}  // namespace

Result<std::vector<StoredCluster>> SessionReads::clusters() const {
    using Clusters = std::vector<StoredCluster>;
    return read_consistently(*database_, [](const ReadView& view) -> Result<Clusters> {
        const auto records = read_clusters(view);
        if (!records.ok()) return records.error();
        Clusters live;
        for (const auto& [id, record] : *records) {
            if (!record.removed) live.push_back(record.cluster);
        }
        return live;
    });
}

Result<ClusterId> SessionReads::next_cluster_id() const {
    return read_consistently(*database_, [](const ReadView& view) -> Result<ClusterId> {
        // Removed clusters are there as tombstones, so the last key is the last id ever used.
        const auto last = view.last_key(Family::kClusters);
        if (!last.ok()) return last.error();
        if (!last->has_value()) return ClusterId{0};
        const auto id = decode_cluster_key(**last);
        if (!id) {
            return view.about(Family::kClusters, **last,
                              {ErrorCode::kDamaged, "is under an impossible key"});
        }
        return static_cast<ClusterId>(index_of(*id) + 1);
    });
}

Result<std::optional<StoredSolution>> SessionReads::solution(ClusterId cluster) const {
    using MaybeSolution = std::optional<StoredSolution>;
    return read_consistently(*database_, [&](const ReadView& view) -> Result<MaybeSolution> {
        const SolutionKey upper{cluster, std::numeric_limits<std::uint32_t>::max()};
        const auto found = view.at_or_before(Family::kSolutions, encode_key(upper));
        if (!found.ok()) return found.error();
        if (!found->has_value()) return MaybeSolution();
        const auto key = decode_solution_key((*found)->first);
        if (!key || key->cluster != cluster) return MaybeSolution();
        auto whole = read_whole(view, *key);
        if (!whole.ok()) return whole.error();
        if (!whole->has_value()) {
            const auto record = fetch<ClusterRecord>(
                view, Family::kClusters, RecordKind::kCluster, encode_key(cluster),
                [&](std::string_view payload) { return decode_cluster(cluster, payload); });
            if (!record.ok()) return record.error();
            // The last solution of a removed cluster goes when nothing needs it any more.
            if (record->has_value() && (*record)->removed) return MaybeSolution();
            return missing(view, Family::kPoints, *key);
        }
        auto model = std::make_shared<const Reconstruction>(std::move((*whole)->model));
        return MaybeSolution(StoredSolution{cluster, key->revision, std::move(model),
                                            std::move((*whole)->state_json)});
    });
}

Result<std::shared_ptr<const Reconstruction>> SessionReads::recycled_model(
    const SolutionReference& solution) const {
    return read_consistently(*database_, [&](const ReadView& view) -> Result<ModelPtr> {
        auto whole = read_whole(view, solution);
        if (!whole.ok()) return whole.error();
        if (!whole->has_value()) return ModelPtr();
        return std::make_shared<const Reconstruction>(std::move((*whole)->model));
    });
}

Result<SessionReads::ModelPtr> SessionReads::read_model(const ReadView& view,
                                                        const SolutionKey& key,
                                                        WithPoints with_points) const {
    const bool whole_model = with_points == WithPoints::kYes;
    const DecodedCache::Key cache_key{whole_model ? RecordKind::kPoints : RecordKind::kPoses,
                                      index_of(key.cluster), key.revision};
    if (auto cached = cache_.find<Reconstruction>(cache_key)) return cached;
    ModelPtr model;
    if (whole_model) {
        auto whole = read_whole(view, key);
        if (!whole.ok()) return whole.error();
        if (!whole->has_value()) return missing(view, Family::kPoints, key);
        model = std::make_shared<const Reconstruction>(std::move((*whole)->model));
    } else {
        auto poses = read_poses(view, key);
        if (!poses.ok()) return poses.error();
        if (!poses->has_value()) return missing(view, Family::kSolutions, key);
        model = std::make_shared<const Reconstruction>(std::move(**poses));
    }
    cache_.put(cache_key, model, bytes_of(*model));
    return model;
}

Result<Scene> SessionReads::assemble(const ReadView& view, const SceneRecord& record,
                                     WithPoints with_points) const {
    Scene scene;
    scene.version = record.scene.version;
    scene.image_count = record.scene.image_count;
    scene.effective_clusters = record.scene.effective_clusters;
    for (const StoredPlacement& placement : record.scene.placements) {
        auto cluster = std::make_shared<SceneCluster>();
        cluster->id = placement.cluster;
        cluster->revision = placement.revision;
        cluster->members = placement.members;
        cluster->world_from_cluster = placement.world_from_cluster;
        cluster->effective_cluster = placement.effective_cluster;
        if (placement.revision > 0) {
            auto model = read_model(view, {placement.cluster, placement.revision}, with_points);
            if (!model.ok()) return model.error();
            cluster->model = std::move(*model);
            // A solution may still hold images that another cluster shows by now.
            if (places_others_than(*cluster->model, cluster->members)) {
                cluster->model = std::make_shared<const Reconstruction>(
                    restricted_to(*cluster->model, cluster->members));
            }
        }
        scene.clusters.push_back(std::move(cluster));
    }
    return scene;
}

Result<Scene> SessionReads::scene() const {
    return latest_scene(WithPoints::kYes);
}

Result<Scene> SessionReads::scene_poses() const {
    return latest_scene(WithPoints::kNo);
}

Result<Scene> SessionReads::latest_scene(WithPoints with_points) const {
    return read_consistently(*database_, [&](const ReadView& view) -> Result<Scene> {
        const auto record = read_latest_scene(view);
        if (!record.ok()) return record.error();
        if (!record->has_value()) return Scene{};
        return assemble(view, **record, with_points);
    });
}

Result<std::string> SessionReads::scene_summary_json() const {
    return read_consistently(*database_, [](const ReadView& view) -> Result<std::string> {
        const auto record = read_latest_scene(view);
        if (!record.ok()) return record.error();
        return record->has_value() ? (*record)->scene.summary_json : std::string();
    });
}

Result<std::vector<PastVersion>> SessionReads::versions() const {
    return read_consistently(*database_, [](const ReadView& view) { return read_versions(view); });
}

Result<Scene> SessionReads::scene_after(std::uint32_t image_count) const {
    return read_consistently(*database_, [&](const ReadView& view) -> Result<Scene> {
        const auto record = read_scene_after(view, image_count);
        if (!record.ok()) return record.error();
        if (!record->has_value()) {
            return Error{ErrorCode::kNotFound,
                         database_->label() + " keeps no version with at most " +
                             std::to_string(image_count) +
                             " images; versions are kept with '--history poses' or 'full'"};
        }
        const auto latest = read_latest_scene(view);
        if (!latest.ok()) return latest.error();
        const bool is_latest =
            latest->has_value() && (*latest)->scene.version == (*record)->scene.version;
        const bool kept = std::ranges::all_of((*record)->points_kept, [](bool k) { return k; });
        return assemble(view, **record, is_latest || kept ? WithPoints::kYes : WithPoints::kNo);
    });
}

}  // namespace psfm
