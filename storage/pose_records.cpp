// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <functional>

#include "storage/flat_payload.h"
#include "storage/generated/records_generated.h"
#include "storage/geometry_records.h"
#include "storage/solution_records.h"

namespace psfm {
namespace {

const char* problem_of(const Reconstruction& model) {
    if (std::ranges::adjacent_find(model.images, std::greater_equal<>{}, &RegisteredImage::image) !=
        model.images.end()) {
        return "registered images are not ascending";
    }
    for (const RegisteredImage& image : model.images) {
        if (!is_sound(image.cam_from_cluster)) return "pose is not a rigid motion";
        if (!model.cameras.contains(image.camera)) return "camera of a registered image is missing";
    }
    for (const auto& [id, camera] : model.cameras) {
        if (!is_sound(camera)) return "camera is impossible";
    }
    return nullptr;
}

}  // namespace

Result<std::string> encode_poses(const Reconstruction& model) {
    if (const char* problem = problem_of(model)) return not_storable(problem);
    flatbuffers::FlatBufferBuilder builder;
    std::vector<records::Pose> poses;
    poses.reserve(model.images.size());
    for (const RegisteredImage& image : model.images) {
        poses.emplace_back(index_of(image.image), index_of(image.camera),
                           to_record(image.cam_from_cluster));
    }
    std::vector<flatbuffers::Offset<records::ClusterCamera>> cameras;
    for (const auto& [id, camera] : model.cameras) {
        const auto offset = add_camera(builder, camera);
        cameras.push_back(records::CreateClusterCamera(builder, index_of(id), offset));
    }
    const auto camera_vector = builder.CreateVector(cameras);
    const auto pose_vector = builder.CreateVectorOfStructs(poses);
    builder.Finish(records::CreatePoses(builder, pose_vector, camera_vector));
    return finished(builder);
}

Result<Reconstruction> decode_poses(std::string_view payload) {
    const FlatPayload flat(payload);
    const auto* record = flat.root<records::Poses>();
    if (record == nullptr) return damaged_payload(kNotATable);
    if (!is_aligned(*record->images(), alignof(records::Pose))) return damaged_payload(kNotATable);
    Reconstruction model;
    model.images.reserve(record->images()->size());
    for (const records::Pose* pose : *record->images()) {
        model.images.push_back({static_cast<ImageId>(pose->image()),
                                static_cast<CameraId>(pose->camera()),
                                from_record(pose->cam_from_cluster())});
    }
    for (const records::ClusterCamera* entry : *record->cameras()) {
        const auto camera = from_record(*entry->camera());
        if (!camera) return camera.error();
        if (!model.cameras.emplace(static_cast<CameraId>(entry->id()), *camera).second) {
            return damaged_payload("camera is there twice");
        }
    }
    if (const char* problem = problem_of(model)) return damaged_payload(problem);
    return model;
}

}  // namespace psfm
