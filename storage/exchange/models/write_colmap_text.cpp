// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/write_formats.h"

namespace psfm {
namespace {

void write_cameras_text(const ExportedModel& model, OutputFile& file) {
    file.text("# Camera list with one line of data per camera:\n");
    file.text("#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n");
    for (const auto& [id, camera] : model.cameras) {
        file.numbers(id);
        file.text(model_name(camera.model));
        file.text(" ");
        file.numbers(camera.width, camera.height);
        for (int i = 0; i < parameter_count(camera.model); ++i) {
            file.numbers(camera.params.at(static_cast<std::size_t>(i)));
        }
        file.text("\n");
    }
}

void write_images_text(const ExportedModel& model, OutputFile& file) {
    file.text("# Image list with two lines of data per image:\n");
    file.text("#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n");
    file.text("#   POINTS2D[] as (X, Y, POINT3D_ID)\n");
    for (const ExportedImage& image : model.images) {
        const Eigen::Quaterniond& rotation = image.cam_from_world.rotation;
        const Eigen::Vector3d& translation = image.cam_from_world.translation;
        file.numbers(image.id, rotation.w(), rotation.x(), rotation.y(), rotation.z(),
                     translation.x(), translation.y(), translation.z(), image.camera_id);
        file.text(image.name);
        file.text("\n");
        for (const ExportedKeypoint& keypoint : image.keypoints) {
            file.numbers(keypoint.x, keypoint.y);
            if (keypoint.point == kNoPoint) {
                file.text("-1 ");
            } else {
                file.numbers(keypoint.point);
            }
        }
        file.text("\n");
    }
}

void write_points_text(const ExportedModel& model, OutputFile& file) {
    file.text("# 3D point list with one line of data per point:\n");
    file.text("#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n");
    for (const ExportedPoint& point : model.points) {
        file.numbers(point.id, point.position.x(), point.position.y(), point.position.z(),
                     point.rgb[0], point.rgb[1], point.rgb[2], point.error_px);
        for (const ExportedObservation& observation : point.track) {
            file.numbers(observation.image_id, observation.keypoint);
        }
        file.text("\n");
    }
}

}  // namespace

Result<void> stage_colmap_text(const ExportedModel& model, const std::filesystem::path& place,
                               StagedFiles& files) {
    for (const ExportedImage& image : model.images) {
        if (image.name.find_first_of(" \t\r\n") != std::string::npos) {
            return Error{
                ErrorCode::kInvalidArgument,
                "\"" + image.name +
                    "\" has a space in its name, which COLMAP's text format cannot hold: export "
                    "with --format colmap"};
        }
    }
    const auto write = [&](const char* name, auto write_part) {
        return files.write(place / name, [&](OutputFile& file) { write_part(model, file); });
    };
    if (auto written = write("cameras.txt", write_cameras_text); !written.ok())
        return written.error();
    if (auto written = write("images.txt", write_images_text); !written.ok())
        return written.error();
    return write("points3D.txt", write_points_text);
}

}  // namespace psfm
