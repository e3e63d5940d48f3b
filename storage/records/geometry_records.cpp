// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/records/geometry_records.h"

#include <algorithm>
#include <cmath>

#include "storage/records/flat_payload.h"

namespace psfm {
namespace {

records::Quaternion to_record(const Eigen::Quaterniond& q) {
    return {q.w(), q.x(), q.y(), q.z()};
}
records::Vector3 to_record(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

Eigen::Quaterniond quaternion_of(const records::Quaternion& q) {
    return {q.w(), q.x(), q.y(), q.z()};
}
Eigen::Vector3d vector_of(const records::Vector3& v) {
    return {v.x(), v.y(), v.z()};
}

}  // namespace

records::Rigid to_record(const Rigid3& motion) {
    return {to_record(motion.rotation), to_record(motion.translation)};
}

records::Similarity to_record(const Sim3& motion) {
    return {motion.scale, to_record(motion.rotation), to_record(motion.translation)};
}

Rigid3 from_record(const records::Rigid& record) {
    return {quaternion_of(record.rotation()), vector_of(record.translation())};
}

Sim3 from_record(const records::Similarity& record) {
    return {record.scale(), quaternion_of(record.rotation()), vector_of(record.translation())};
}

flatbuffers::Offset<records::Camera> add_camera(flatbuffers::FlatBufferBuilder& builder,
                                                const Camera& camera) {
    const auto params = builder.CreateVector(camera.params.data(), camera.params.size());
    return records::CreateCamera(builder, static_cast<std::uint8_t>(camera.model),
                                 static_cast<std::uint8_t>(camera.focal_source), camera.width,
                                 camera.height, params);
}

Result<Camera> from_record(const records::Camera& record) {
    Camera camera;
    if (record.params()->size() != camera.params.size()) {
        return damaged_payload("camera has another number of parameters than 8");
    }
    if (!is_aligned(*record.params(), alignof(double))) return damaged_payload(kNotATable);
    camera.model = static_cast<CameraModel>(record.model());
    camera.focal_source = static_cast<FocalSource>(record.focal_source());
    camera.width = record.width();
    camera.height = record.height();
    std::ranges::copy(*record.params(), camera.params.begin());
    if (!is_sound(camera)) return damaged_payload("camera is impossible");
    return camera;
}

namespace {

/// Guard: rotations are written as they were normalised; what is further off is a damaged record.
constexpr double kUnitRounding = 1e-6;

}  // namespace

bool is_sound(const Rigid3& motion) {
    return std::abs(motion.rotation.norm() - 1.0) < kUnitRounding && motion.translation.allFinite();
}

bool is_sound(const Sim3& motion) {
    return std::isfinite(motion.scale) && motion.scale > 0.0 &&
           std::abs(motion.rotation.norm() - 1.0) < kUnitRounding && motion.translation.allFinite();
}

bool is_sound(const Camera& camera) {
    return camera.model <= CameraModel::kOpenCv && camera.focal_source <= FocalSource::kEstimated &&
           camera.width > 0 && camera.height > 0 &&
           std::ranges::all_of(camera.params, [](double p) { return std::isfinite(p); }) &&
           camera.fx() > 0.0 && camera.fy() > 0.0;
}

}  // namespace psfm
