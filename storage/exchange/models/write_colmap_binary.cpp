// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/write_formats.h"

namespace psfm {
namespace {

void write_cameras_binary(const ExportedModel& model, OutputFile& file) {
    file.little_endian(static_cast<std::uint64_t>(model.cameras.size()));
    for (const auto& [id, camera] : model.cameras) {
        file.little_endian(id);
        file.little_endian(static_cast<std::int32_t>(camera.model));
        file.little_endian(static_cast<std::uint64_t>(camera.width));
        file.little_endian(static_cast<std::uint64_t>(camera.height));
        for (int i = 0; i < parameter_count(camera.model); ++i) {
            file.little_endian(camera.params.at(static_cast<std::size_t>(i)));
        }
    }
}

void write_images_binary(const ExportedModel& model, OutputFile& file) {
    file.little_endian(static_cast<std::uint64_t>(model.images.size()));
    for (const ExportedImage& image : model.images) {
        file.little_endian(image.id);
        const Eigen::Quaterniond& rotation = image.cam_from_world.rotation;
        for (const double value : {rotation.w(), rotation.x(), rotation.y(), rotation.z()}) {
            file.little_endian(value);
        }
        for (const double value : image.cam_from_world.translation) file.little_endian(value);
        file.little_endian(image.camera_id);
        file.text(image.name);
        file.little_endian('\0');
        file.little_endian(static_cast<std::uint64_t>(image.keypoints.size()));
        for (const ExportedKeypoint& keypoint : image.keypoints) {
            file.little_endian(keypoint.x);
            file.little_endian(keypoint.y);
            file.little_endian(keypoint.point);
        }
    }
}

void write_points_binary(const ExportedModel& model, OutputFile& file) {
    file.little_endian(static_cast<std::uint64_t>(model.points.size()));
    for (const ExportedPoint& point : model.points) {
        file.little_endian(point.id);
        for (const double value : point.position) file.little_endian(value);
        for (const std::uint8_t value : point.rgb) file.little_endian(value);
        file.little_endian(point.error_px);
        file.little_endian(static_cast<std::uint64_t>(point.track.size()));
        for (const ExportedObservation& observation : point.track) {
            file.little_endian(observation.image_id);
            file.little_endian(observation.keypoint);
        }
    }
}

}  // namespace

Result<void> stage_colmap_binary(const ExportedModel& model, const std::filesystem::path& place,
                                 StagedFiles& files) {
    const auto write = [&](const char* name, auto write_part) {
        return files.write(place / name, [&](OutputFile& file) { write_part(model, file); });
    };
    if (auto written = write("cameras.bin", write_cameras_binary); !written.ok())
        return written.error();
    if (auto written = write("images.bin", write_images_binary); !written.ok())
        return written.error();
    return write("points3D.bin", write_points_binary);
}

}  // namespace psfm
