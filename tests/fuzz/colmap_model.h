// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "storage/exchange/models/read_colmap.h"
#include "tests/fuzz/fuzz_input.h"

namespace psfm::fuzz {

/// Contents of a COLMAP model's files.
struct ModelFiles {
    std::span<const std::uint8_t> cameras, images, points;
};

/// Reads a model as `psfm evaluate` and others do, and checks what read_colmap_model() promises.
/// @param ending  ".txt" or ".bin"
inline void read_model(const InputFolder& folder, const ModelFiles& files,
                       const std::string& ending) {
    folder.write(("cameras" + ending).c_str(), files.cameras);
    folder.write(("images" + ending).c_str(), files.images);
    folder.write(("points3D" + ending).c_str(), files.points);
    (void)read_colmap_model(folder.path(), {.cameras = false, .keypoints = false, .points = false});
    const auto model = read_colmap_model(folder.path());
    if (!model.ok()) return;
    for (const ExportedImage& image : model->images) {
        require(is_safe_name(image.name), "names lie within the photograph folder");
        require(model->find_camera(image.camera_id) != nullptr, "images have their camera");
    }
    for (const ExportedPoint& point : model->points) {
        for (const ExportedObservation& observation : point.track) {
            const ExportedImage* image = model->find_image(observation.image_id);
            require(image != nullptr && observation.keypoint < image->keypoints.size(),
                    "tracks are of features that are there");
        }
    }
}

}  // namespace psfm::fuzz
