// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/records/scene_records.h"

#include <cassert>

#include "storage/records/compact_list.h"
#include "storage/records/flat_payload.h"
#include "storage/records/generated/records_generated.h"
#include "storage/records/geometry_records.h"

namespace psfm {
namespace {

const char* problem_of(const StoredSceneVersion& scene) {
    const StoredPlacement* before = nullptr;
    for (const StoredPlacement& placement : scene.placements) {
        if (before != nullptr && before->cluster >= placement.cluster) {
            return "placements are not ascending by cluster";
        }
        if (!strictly_ascending(placement.members)) return "placed members are not ascending";
        if (!placement.members.empty() && index_of(placement.members.back()) >= scene.image_count) {
            return "placed member is not one of the version's images";
        }
        if (!is_sound(placement.world_from_cluster)) {
            return "placement is not a similarity transform";
        }
        before = &placement;
    }
    return nullptr;
}

}  // namespace

Result<std::string> encode_scene(const SceneRecord& record) {
    const StoredSceneVersion& scene = record.scene;
    assert(record.points_kept.size() == scene.placements.size());
    if (const char* problem = problem_of(scene)) {
        return not_storable("scene version " + std::to_string(scene.version) + ": " + problem);
    }
    flatbuffers::FlatBufferBuilder builder;
    std::vector<flatbuffers::Offset<records::Placement>> offsets;
    for (std::size_t i = 0; i < scene.placements.size(); ++i) {
        const StoredPlacement& placement = scene.placements[i];
        const auto members = builder.CreateVector(encode_members(placement.members));
        const records::Similarity motion = to_record(placement.world_from_cluster);
        offsets.push_back(records::CreatePlacement(
            builder, index_of(placement.cluster), placement.revision, members, &motion,
            placement.effective_cluster, record.points_kept[i]));
    }
    const auto placements = builder.CreateVector(offsets);
    const auto summary = builder.CreateString(scene.summary_json);
    builder.Finish(records::CreateScene(builder, scene.effective_clusters, placements, summary));
    return finished(builder);
}

Result<SceneRecord> decode_scene(const SceneKey& key, std::string_view payload) {
    const FlatPayload flat(payload);
    const auto* table = flat.root<records::Scene>();
    if (table == nullptr) return damaged_payload(kNotATable);
    SceneRecord record;
    record.scene.version = key.version;
    record.scene.image_count = key.image_count;
    record.scene.effective_clusters = table->effective_clusters();
    record.scene.summary_json = table->summary_json()->str();
    for (const records::Placement* entry : *table->placements()) {
        auto members = decode_members(bytes_of(*entry->members()));
        if (!members) return damaged_payload("list of placed members is broken");
        record.scene.placements.push_back(
            {static_cast<ClusterId>(entry->cluster()), entry->revision(), std::move(*members),
             from_record(*entry->world_from_cluster()), entry->effective_cluster()});
        record.points_kept.push_back(entry->points_kept());
    }
    if (const char* problem = problem_of(record.scene)) return damaged_payload(problem);
    return record;
}

}  // namespace psfm
