// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/given_cameras.h"

#include <sstream>

#include "storage/exchange/models/read_colmap.h"

namespace psfm {
namespace {

/// Equal intrinsics have equal keys: reference models often list one physical camera once an image.
std::string key_of(const Camera& camera) {
    std::ostringstream key;
    key.precision(17);
    key << model_name(camera.model) << ' ' << camera.width << 'x' << camera.height;
    for (int i = 0; i < parameter_count(camera.model); ++i)
        key << ' ' << camera.params.at(static_cast<std::size_t>(i));
    return key.str();
}

}  // namespace

Result<std::map<std::string, GivenCamera>> read_given_cameras(const std::filesystem::path& folder) {
    const auto model =
        read_colmap_model(folder, {.cameras = true, .keypoints = false, .points = false});
    if (!model.ok()) return model.error();
    std::map<std::string, GivenCamera> cameras;
    for (const ExportedImage& image : model->images) {
        Camera camera = model->find_camera(image.camera_id)->camera;
        if (const auto valid = validate(camera); !valid.ok()) {
            return Error{ErrorCode::kInvalidArgument, "camera " + std::to_string(image.camera_id) +
                                                          " in " + folder.string() + ": " +
                                                          valid.error().message};
        }
        camera.focal_source = FocalSource::kGiven;
        cameras[image.name] = {key_of(camera), camera};
    }
    return cameras;
}

}  // namespace psfm
