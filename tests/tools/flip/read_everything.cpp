// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/tools/flip/read_everything.h"

#include <algorithm>

#include "storage/records/cluster_records.h"
#include "storage/records/image_records.h"
#include "storage/records/pair_records.h"
#include "storage/records/scene_records.h"
#include "storage/records/solution_records.h"
#include "storage/session/session_store.h"

namespace psfm::testing {
namespace {

std::string text_of(const Reconstruction& model) {
    return encode_poses(model).value() + encode_points(model, {}).value();
}

std::string text_of(const std::vector<Image>& images) {
    std::string text;
    for (const Image& image : images)
        text += image.name + std::to_string(index_of(image.id)) + encode_image(image).value();
    return text;
}

std::string text_of(const std::map<CameraId, Camera>& cameras) {
    std::string text;
    for (const auto& [id, camera] : cameras)
        text += std::to_string(index_of(id)) + encode_camera(camera).value();
    return text;
}

std::string text_of(const std::vector<RejectedPhoto>& photos) {
    std::string text;
    for (const RejectedPhoto& photo : photos) text += photo.name + encode_rejected(photo).value();
    return text;
}

std::string text_of(const std::vector<StoredCluster>& clusters) {
    std::string text;
    for (const StoredCluster& cluster : clusters)
        text += std::to_string(index_of(cluster.id)) + encode_cluster({cluster, false}).value();
    return text;
}

std::string text_of(const Scene& scene) {
    SceneRecord record;
    record.scene.version = scene.version;
    record.scene.image_count = scene.image_count;
    record.scene.effective_clusters = scene.effective_clusters;
    std::string models;
    for (const auto& cluster : scene.clusters) {
        record.scene.placements.push_back({cluster->id, cluster->revision, cluster->members,
                                           cluster->world_from_cluster,
                                           cluster->effective_cluster});
        record.points_kept.push_back(false);
        if (cluster->model) models += text_of(*cluster->model);
    }
    return std::to_string(scene.version) + encode_scene(record).value() + models;
}

std::string text_of(const std::optional<StoredSolution>& solution) {
    if (!solution) return "none";
    return std::to_string(solution->revision) + solution->state_json + text_of(*solution->model);
}

/// Reads one value after the other.
class Reading {
  public:
    explicit Reading(Contents& contents) : contents_(contents) {}

    /// @param text  of the value, a function
    template <typename T, typename Text>
    void note(const std::string& what, const Result<T>& value, const Text& text) {
        contents_.values[what] = value.ok() ? text(*value) : kFailed;
    }
    template <typename T>
    void note(const std::string& what, const Result<T>& value) {
        note(what, value, [](const T& v) { return text_of(v); });
    }

  private:
    Contents& contents_;
};

void read_image(const SessionReader& reader, ImageId id, Reading& reading) {
    const std::string number = std::to_string(index_of(id));
    reading.note("keypoints of " + number, reader.keypoints(id),
                 [](const auto& v) { return encode_keypoints(*v).value(); });
    reading.note("descriptors of " + number, reader.descriptors(id),
                 [](const auto& v) { return encode_descriptors(*v).value(); });
    reading.note("pairs of " + number, reader.pairs_of(id),
                 [&](const auto& v) { return encode_pairs(id, v).value(); });
    reading.note("scene after " + number, reader.scene_after(index_of(id) + 1));
}

}  // namespace

bool Contents::failed() const {
    return !opens ||
           std::ranges::any_of(values, [](const auto& value) { return value.second == kFailed; });
}

Contents read_everything(const std::filesystem::path& session) {
    Contents contents;
    const auto opened = open_session_reader(session, {});
    if (!opened) return contents;
    contents.opens = true;
    const SessionReader& reader = **opened;
    Reading reading(contents);
    reading.note("settings", reader.settings(),
                 [](const SessionSettings& v) { return v.photo_folder + v.settings_json; });
    const auto images = reader.images();
    reading.note("images", images);
    reading.note("cameras", reader.cameras());
    reading.note("rejected", reader.rejected());
    reading.note("verified", reader.verified_image_count(),
                 [](std::uint32_t n) { return std::to_string(n); });
    for (std::uint32_t i = 0; images && i < images->size(); ++i)
        read_image(reader, static_cast<ImageId>(i), reading);
    const auto clusters = reader.clusters();
    reading.note("clusters", clusters);
    reading.note("next cluster", reader.next_cluster_id(),
                 [](ClusterId id) { return std::to_string(index_of(id)); });
    for (std::size_t i = 0; clusters && i < clusters->size(); ++i) {
        const ClusterId id = (*clusters)[i].id;
        reading.note("solution of " + std::to_string(index_of(id)), reader.solution(id));
    }
    reading.note("scene", reader.scene());
    reading.note("summary", reader.scene_summary_json(), [](const std::string& v) { return v; });
    const auto report = reader.check({});
    contents.check_is_clean = report && report->damaged.empty();
    return contents;
}

std::string changed(const Contents& original, const Contents& now) {
    if (!now.opens) return "";
    std::string text;
    // Of a list that cannot be read its members are not asked for.
    const auto list_failed = [&](const std::string& what) {
        const auto value = now.values.find(what);
        return value == now.values.end() || value->second == kFailed;
    };
    const bool lists_failed = list_failed("images") || list_failed("clusters");
    for (const auto& [what, value] : original.values) {
        const auto found = now.values.find(what);
        if (found == now.values.end() ? !lists_failed
                                      : found->second != value && found->second != kFailed) {
            text += what + "; ";
        }
    }
    return text;
}

}  // namespace psfm::testing
