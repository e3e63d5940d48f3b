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

}  // namespace

Result<void> write_colmap_truth(const PhotoPlan& plan, const std::filesystem::path& folder) {
    std::string cameras = "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n1 ";
    cameras += model_name(plan.camera.model);
    cameras += ' ' + std::to_string(plan.camera.width) + ' ' + std::to_string(plan.camera.height);
    for (int i = 0; i < parameter_count(plan.camera.model); ++i) {
        cameras += ' ' + exactly(plan.camera.params[static_cast<std::size_t>(i)]);
    }
    std::string images =
        "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
        "# (empty line: no 2D points)\n";
    for (std::size_t i = 0; i < plan.photos.size(); ++i) {
        const Rigid3& pose = plan.photos[i].cam_from_world;
        images += std::to_string(i + 1);
        for (const double value :
             {pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z(),
              pose.translation.x(), pose.translation.y(), pose.translation.z()}) {
            images += ' ' + exactly(value);
        }
        images += " 1 " + plan.photos[i].name + "\n\n";
    }
    if (auto written = write_text(folder / "cameras.txt", cameras + '\n'); !written) return written;
    if (auto written = write_text(folder / "images.txt", images); !written) return written;
    return write_text(folder / "points3D.txt", "# empty\n");
}

}  // namespace psfm::synthetic
