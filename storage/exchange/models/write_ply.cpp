// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/dataset_model.h"
#include "storage/exchange/models/distinct_points.h"
#include "storage/exchange/models/write_formats.h"

namespace psfm {
namespace {

/// Format: cameras are green among the points.
constexpr std::array<std::uint8_t, 3> kCameraColour{0, 255, 0};

void write_vertex(const Eigen::Vector3d& position, const std::array<std::uint8_t, 3>& rgb,
                  bool normal, OutputFile& file) {
    for (const double value : position) file.little_endian(static_cast<float>(value));
    for (int axis = 0; normal && axis < 3; ++axis) file.little_endian(0.F);
    for (const std::uint8_t value : rgb) file.little_endian(value);
}

}  // namespace

Result<void> stage_ply(const ExportedModel& model, const std::filesystem::path& place,
                       PlyContents contents, StagedFiles& files) {
    return files.write(place.string() + ".ply", [&](OutputFile& file) {
        const bool cameras = contents == PlyContents::kPointsAndCameras;
        const bool normals = contents == PlyContents::kPointsWithNormals;
        const Eigen::Vector3d origin = float_origin(model);
        const std::vector<std::size_t> points = distinct_points(model.points, origin);
        const std::size_t vertices = points.size() + (cameras ? model.images.size() : 0);
        file.text("ply\nformat binary_little_endian 1.0\n");
        file.text(cameras ? "comment psfm: points, then camera centres in pure green\n"
                          : "comment psfm: points\n");
        if (!origin.isZero()) {
            file.text("comment origin ");
            file.numbers(origin.x(), origin.y(), origin.z());
            file.text("\n");
        }
        file.text("element vertex ");
        file.number(static_cast<std::uint64_t>(vertices));
        file.text("\nproperty float x\nproperty float y\nproperty float z\n");
        if (normals) file.text("property float nx\nproperty float ny\nproperty float nz\n");
        file.text("property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n");
        for (const std::size_t p : points) {
            const ExportedPoint& point = model.points[p];
            write_vertex(point.position - origin, point.rgb, normals, file);
        }
        if (!cameras) return;
        for (const ExportedImage& image : model.images) {
            write_vertex(image.cam_from_world.target_origin_in_source() - origin, kCameraColour,
                         normals, file);
        }
    });
}

}  // namespace psfm
