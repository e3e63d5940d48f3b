// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/image_positions.h"
#include "storage/exchange/models/write_formats.h"

namespace psfm {
namespace {

/// VisualSFM writes spaces in names as double quotes.
std::string nvm_name(std::string name) {
    std::ranges::replace(name, ' ', '"');
    return name;
}

void write_nvm_camera(const ExportedImage& image, const Camera& camera, OutputFile& file) {
    const Eigen::Quaterniond& rotation = image.cam_from_world.rotation;
    const Eigen::Vector3d centre = image.cam_from_world.target_origin_in_source();
    file.text(nvm_name(image.name));
    file.text(" ");
    file.numbers(camera.mean_focal(), rotation.w(), rotation.x(), rotation.y(), rotation.z(),
                 centre.x(), centre.y(), centre.z(), -single_radial_distortion(camera));
    file.text("0\n");
}

void write_nvm_point(const ExportedModel& model, const ExportedPoint& point, OutputFile& file) {
    file.numbers(point.position.x(), point.position.y(), point.position.z(), point.rgb[0],
                 point.rgb[1], point.rgb[2]);
    write_measurements(model, point, ImageY::kDown, file);
    file.text("\n");
}

}  // namespace

Result<void> stage_nvm(const ExportedModel& model, const std::filesystem::path& place,
                       StagedFiles& files) {
    for (const ExportedImage& image : model.images) {
        if (image.name.find_first_of("\"\t\r\n") != std::string::npos) {
            return Error{ErrorCode::kInvalidArgument,
                         image.name +
                             " has a quote or line break in its name, which NVM cannot hold: "
                             "export with --format colmap"};
        }
    }
    return files.write(place.string() + ".nvm", [&](OutputFile& file) {
        file.text("NVM_V3\n\n");
        file.number(static_cast<std::uint64_t>(model.images.size()));
        file.text("\n");
        for (const ExportedImage& image : model.images) {
            write_nvm_camera(image, model.find_camera(image.camera_id)->camera, file);
        }
        file.text("\n");
        file.number(static_cast<std::uint64_t>(model.points.size()));
        file.text("\n");
        for (const ExportedPoint& point : model.points) write_nvm_point(model, point, file);
        file.text("\n0\n");  // no further model follows
    });
}

}  // namespace psfm
