// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/image_positions.h"
#include "storage/exchange/models/write_formats.h"

namespace psfm {
namespace {

void write_bundler_camera(const ExportedImage& image, const Camera& camera, OutputFile& file) {
    const auto [k1, k2] = radial_distortion(camera);
    file.numbers(camera.mean_focal(), k1, k2);
    file.text("\n");
    // Bundler's camera has y up and looks down -z: half a turn about x.
    const Eigen::Vector3d half_turn(1.0, -1.0, -1.0);
    const Eigen::Matrix3d rotation =
        half_turn.asDiagonal() * image.cam_from_world.rotation.toRotationMatrix();
    const Eigen::Vector3d translation = half_turn.asDiagonal() * image.cam_from_world.translation;
    for (int row = 0; row < 3; ++row) {
        file.numbers(rotation(row, 0), rotation(row, 1), rotation(row, 2));
        file.text("\n");
    }
    file.numbers(translation.x(), translation.y(), translation.z());
    file.text("\n");
}

void write_bundler_point(const ExportedModel& model, const ExportedPoint& point, OutputFile& file) {
    file.numbers(point.position.x(), point.position.y(), point.position.z());
    file.text("\n");
    file.numbers(point.rgb[0], point.rgb[1], point.rgb[2]);
    file.text("\n");
    write_measurements(model, point, ImageY::kUp, file);
    file.text("\n");
}

}  // namespace

Result<void> stage_bundler(const ExportedModel& model, const std::filesystem::path& place,
                           StagedFiles& files) {
    for (const ExportedImage& image : model.images) {
        // Its readers take what follows a space for a focal length.
        if (image.name.find_first_of(" \t\r\n") != std::string::npos) {
            return Error{ErrorCode::kInvalidArgument,
                         "\"" + image.name +
                             "\" has a space in its name, which Bundler's list cannot hold: export "
                             "with --format colmap"};
        }
    }
    auto written = files.write(place / "bundle.out", [&](OutputFile& file) {
        file.text("# Bundle file v0.3\n");
        file.numbers(model.images.size(), model.points.size());
        file.text("\n");
        for (const ExportedImage& image : model.images) {
            write_bundler_camera(image, model.find_camera(image.camera_id)->camera, file);
        }
        for (const ExportedPoint& point : model.points) write_bundler_point(model, point, file);
    });
    if (!written.ok()) return written.error();
    return files.write(place / "list.txt", [&](OutputFile& file) {
        for (const ExportedImage& image : model.images) {
            file.text(image.name);
            file.text("\n");
        }
    });
}

}  // namespace psfm
