// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include "storage/exchange/models/dataset_model.h"
#include "storage/exchange/models/dataset_names.h"
#include "storage/exchange/models/image_positions.h"
#include "storage/exchange/models/write_formats.h"

namespace psfm {
namespace {

using Json = nlohmann::ordered_json;

/// Intrinsics by nerfstudio's names; with all of OPENCV's distortion, which every psfm model is a
/// case of.
void add_intrinsics(const Camera& camera, Json& json) {
    const Eigen::Vector2d principal_point = camera.principal_point();
    const auto [k1, k2] = radial_distortion(camera);
    const bool tangential = camera.model == CameraModel::kOpenCv;
    json["w"] = camera.width;
    json["h"] = camera.height;
    json["fl_x"] = camera.fx();
    json["fl_y"] = camera.fy();
    json["cx"] = principal_point.x();
    json["cy"] = principal_point.y();
    json["k1"] = k1;
    json["k2"] = k2;
    json["p1"] = tangential ? camera.params[6] : 0.0;
    json["p2"] = tangential ? camera.params[7] : 0.0;
}

/// world_from_camera as rows, less the origin, the camera's y up and z backward.
Json transform_matrix(const Rigid3& cam_from_world, const Eigen::Vector3d& origin) {
    Rigid3 world_from_cam = inverse(cam_from_world);
    world_from_cam.translation -= origin;
    const Eigen::Matrix3d rotation =
        world_from_cam.rotation.toRotationMatrix() * Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    Json rows = Json::array();
    for (int row = 0; row < 3; ++row) {
        rows.push_back({rotation(row, 0), rotation(row, 1), rotation(row, 2),
                        world_from_cam.translation(row)});
    }
    rows.push_back({0.0, 0.0, 0.0, 1.0});
    return rows;
}

}  // namespace

Result<void> stage_nerfstudio(const ExportedModel& model, const std::filesystem::path& place,
                              const std::filesystem::path& image_folder,
                              const std::filesystem::path& mask_folder, PlyContents points,
                              StagedFiles& files) {
    Json json{{"camera_model", "OPENCV"}};
    // Per-image values are ignored where global ones exist, so these are for a single camera only.
    const bool one_camera = model.cameras.size() == 1;
    if (one_camera) add_intrinsics(model.cameras.front().camera, json);
    json["ply_file_path"] = "sparse_pc.ply";
    json["frames"] = Json::array();
    const Eigen::Vector3d origin = float_origin(model);  // as that of sparse_pc.ply
    for (const ExportedImage& image : model.images) {
        Json frame{{"file_path", (image_folder / image.name).generic_string()}};
        if (!mask_folder.empty())
            frame["mask_path"] = (mask_folder / mask_name(image.name)).generic_string();
        if (!one_camera) add_intrinsics(model.find_camera(image.camera_id)->camera, frame);
        frame["transform_matrix"] = transform_matrix(image.cam_from_world, origin);
        frame["colmap_im_id"] = image.id;
        json["frames"].push_back(std::move(frame));
    }
    std::string text;
    try {
        text = json.dump(1) + "\n";
    } catch (const Json::type_error&) {
        return Error{ErrorCode::kInvalidArgument,
                     "a photograph's name is not UTF-8, which JSON cannot hold: export with "
                     "--format colmap"};
    }
    auto written =
        files.write(place / "transforms.json", [&](OutputFile& file) { file.text(text); });
    if (!written.ok()) return written.error();
    return stage_ply(model, place / "sparse_pc", points, files);
}

}  // namespace psfm
