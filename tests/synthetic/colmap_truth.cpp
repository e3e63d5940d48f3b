// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/colmap_truth.h"

#include <fstream>
#include <sstream>
#include <string>

namespace psfm::synthetic {
namespace {

std::string exactly(double value) {
    std::ostringstream text;
    text.precision(17);
    text << value;
    return text.str();
}

Result<void> write_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    stream << text;
    stream.close();
    if (!stream)
        return Error{ErrorCode::kIo,
                     "cannot write " + file.string() + ": is there space, and a right to?"};
    return {};
}

/// The lines of a model, as they gather.
struct ModelText {
    std::string cameras = "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
    std::string images =
        "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
        "# (empty line: no 2D points)\n";

    void add_camera(std::size_t id, const Camera& camera) {
        cameras += std::to_string(id) + ' ';
        cameras += model_name(camera.model);
        cameras += ' ' + std::to_string(camera.width) + ' ' + std::to_string(camera.height);
        for (int i = 0; i < parameter_count(camera.model); ++i) {
            cameras += ' ' + exactly(camera.params[static_cast<std::size_t>(i)]);
        }
        cameras += '\n';
    }

    void add_image(std::size_t id, const Rigid3& pose, std::size_t camera,
                   const std::string& name) {
        images += std::to_string(id);
        for (const double value :
             {pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z(),
              pose.translation.x(), pose.translation.y(), pose.translation.z()}) {
            images += ' ' + exactly(value);
        }
        images += ' ' + std::to_string(camera) + ' ' + name + "\n\n";
    }

    Result<void> write(const std::filesystem::path& folder) const {
        if (auto done = write_text(folder / "cameras.txt", cameras); !done) return done;
        if (auto done = write_text(folder / "images.txt", images); !done) return done;
        return write_text(folder / "points3D.txt", "# empty\n");
    }
};

}  // namespace

Result<void> write_colmap_truth(const PhotoPlan& plan, const std::filesystem::path& folder) {
    ModelText text;
    text.add_camera(1, plan.camera);
    for (std::size_t i = 0; i < plan.photos.size(); ++i) {
        text.add_image(i + 1, plan.photos[i].cam_from_world, 1, plan.photos[i].name);
    }
    return text.write(folder);
}

Result<void> write_colmap_truth(const SyntheticScene& scene, std::span<const std::string> names,
                                const std::filesystem::path& folder) {
    ModelText text;
    for (const auto& [id, camera] : scene.cameras) text.add_camera(index_of(id) + 1, camera);
    for (std::size_t i = 0; i < scene.images.size(); ++i) {
        const SceneImage& image = scene.images[i];
        text.add_image(i + 1, image.cam_from_world, index_of(image.camera) + 1, names[i]);
    }
    return text.write(folder);
}

}  // namespace psfm::synthetic
