// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstring>
#include <functional>
#include <iterator>
#include <utility>

#include "storage/records/flat_payload.h"
#include "storage/records/generated/records_generated.h"
#include "storage/records/geometry_records.h"
#include "storage/records/solution_records.h"

namespace psfm {
namespace {

const char* const kNoCamera = "camera of a registered image is missing";

bool has_cameras(const Reconstruction& model) {
    return std::ranges::all_of(model.images, [&](const RegisteredImage& image) {
        return model.cameras.contains(image.camera);
    });
}

/// Of images and cameras by themselves.
const char* problem_of(const Reconstruction& model) {
    if (std::ranges::adjacent_find(model.images, std::greater_equal<>{}, &RegisteredImage::image) !=
        model.images.end()) {
        return "registered images are not ascending";
    }
    for (const RegisteredImage& image : model.images) {
        if (!is_sound(image.cam_from_cluster)) return "pose is not a rigid motion";
    }
    for (const auto& [id, camera] : model.cameras) {
        if (!is_sound(camera)) return "camera is impossible";
    }
    return nullptr;
}

/// To the last bit: what is read from changes is what it would be if it were stored whole.
bool same_bits(const double* a, const double* b, std::size_t count) {
    return std::memcmp(a, b, count * sizeof(double)) == 0;
}

bool is_same(const RegisteredImage& a, const RegisteredImage& b) {
    const Rigid3& from = a.cam_from_cluster;
    const Rigid3& to = b.cam_from_cluster;
    return a.image == b.image && a.camera == b.camera &&
           same_bits(from.rotation.coeffs().data(), to.rotation.coeffs().data(), 4) &&
           same_bits(from.translation.data(), to.translation.data(), 3);
}

bool is_same(const Camera& a, const Camera& b) {
    return a == b && same_bits(a.params.data(), b.params.data(), a.params.size());
}

/// Images and cameras of a model that `before` does not have so.
Reconstruction changed_poses(const Reconstruction& model, const Reconstruction& before) {
    Reconstruction changed;
    std::ranges::copy_if(model.images, std::back_inserter(changed.images),
                         [&](const RegisteredImage& image) {
                             const RegisteredImage* known = before.find(image.image);
                             return known == nullptr || !is_same(image, *known);
                         });
    for (const auto& [id, camera] : model.cameras) {
        const auto known = before.cameras.find(id);
        if (known == before.cameras.end() || !is_same(camera, known->second))
            changed.cameras.emplace(id, camera);
    }
    return changed;
}

/// REQUIRES: sound
std::string encode(const Reconstruction& model, std::uint32_t since) {
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
    builder.Finish(records::CreatePoses(builder, pose_vector, camera_vector, since));
    return finished(builder);
}

}  // namespace

Result<std::string> encode_poses(const Reconstruction& model) {
    if (const char* problem = problem_of(model)) return not_storable(problem);
    if (!has_cameras(model)) return not_storable(kNoCamera);
    return encode(model, 0);
}

Result<std::string> encode_changed_poses(const Reconstruction& model, const Reconstruction& before,
                                         std::uint32_t since) {
    if (const char* problem = problem_of(model)) return not_storable(problem);
    if (!has_cameras(model)) return not_storable(kNoCamera);
    return encode(changed_poses(model, before), since);
}

Result<SolutionPoses> decode_poses(std::string_view payload) {
    const FlatPayload flat(payload);
    const auto* record = flat.root<records::Poses>();
    if (record == nullptr) return damaged_payload(kNotATable);
    if (!is_aligned(*record->images(), alignof(records::Pose))) return damaged_payload(kNotATable);
    SolutionPoses result;
    result.since = record->since();
    Reconstruction& model = result.model;
    model.images.reserve(record->images()->size());
    for (const records::Pose* pose : *record->images()) {
        model.images.push_back({static_cast<ImageId>(pose->image()),
                                static_cast<CameraId>(pose->camera()),
                                from_record(pose->cam_from_cluster())});
    }
    for (const records::ClusterCamera* entry : *record->cameras()) {
        const auto camera = from_record(*entry->camera());
        if (!camera.ok()) return camera.error();
        if (!model.cameras.emplace(static_cast<CameraId>(entry->id()), *camera).second) {
            return damaged_payload("camera is there twice");
        }
    }
    if (const char* problem = problem_of(model)) return damaged_payload(problem);
    if (result.since == 0 && !has_cameras(model)) return damaged_payload(kNoCamera);
    return result;
}

Result<void> apply(SolutionPoses changes, Reconstruction& poses) {
    for (const auto& [id, camera] : changes.model.cameras)
        poses.cameras.insert_or_assign(id, camera);
    std::vector<RegisteredImage> images;
    images.reserve(poses.images.size() + changes.model.images.size());
    // Both ascend; where both have an image, the changed one is taken.
    std::ranges::set_union(changes.model.images, poses.images, std::back_inserter(images), {},
                           &RegisteredImage::image, &RegisteredImage::image);
    poses.images = std::move(images);
    if (!has_cameras(poses)) return damaged_payload(kNoCamera);
    return {};
}

}  // namespace psfm
