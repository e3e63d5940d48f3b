// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/model_checks.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "graph/camera.h"
#include "graph/wording.h"
#include "stages/algorithms/math/median.h"

namespace psfm {

namespace fs = std::filesystem;

namespace {

/// Poses that are written the other way round put points behind their cameras.
Result<void> check_depths(const ExportedModel& model, const fs::path& folder) {
    std::size_t observations = 0;
    std::size_t behind = 0;
    for (const ExportedPoint& point : model.points) {
        for (const ExportedObservation& seen : point.track) {
            const Rigid3& pose = model.find_image(seen.image_id)->cam_from_world;
            ++observations;
            behind += (pose * point.position).z() <= 0.0 ? 1 : 0;
        }
    }
    if (2 * behind <= observations) return {};
    return Error{ErrorCode::kInvalidArgument,
                 folder.string() + ": points lie behind their cameras, by " +
                     std::to_string(behind) + " of " + counted(observations, "observation") +
                     "; write the model with poses that lead from the world into the camera, as "
                     "COLMAP does"};
}

/// Distance of a point's projection from its feature, as part of the image's longer side.
double relative_error(const ExportedModel& model, const ExportedPoint& point,
                      const ExportedObservation& seen) {
    const ExportedImage& image = *model.find_image(seen.image_id);
    const Camera& camera = model.find_camera(image.camera_id)->camera;
    const auto place = project(camera, image.cam_from_world * point.position);
    if (!place) return std::numeric_limits<double>::max();
    const ExportedKeypoint& feature = image.keypoints[seen.keypoint];
    const double error = (*place - Eigen::Vector2d(feature.x, feature.y)).norm();
    const double relative = error / std::max(camera.width, camera.height);
    return std::isfinite(relative) ? relative : std::numeric_limits<double>::max();
}

Result<void> check_projections(const ExportedModel& model, const fs::path& folder) {
    std::vector<double> errors;
    for (const ExportedPoint& point : model.points) {
        for (const ExportedObservation& seen : point.track)
            errors.push_back(relative_error(model, point, seen));
    }
    // Guard: of poor models it is a tenth of that.
    constexpr double kLargest = 0.05;
    if (errors.empty() || upper_median(std::move(errors)) <= kLargest) return {};
    return Error{ErrorCode::kInvalidArgument,
                 folder.string() +
                     ": most points do not lie where their images' features are, by more than 5 % "
                     "of the image: poses, cameras and features are not of one model"};
}

}  // namespace

Result<void> check_points_are_there(const fs::path& folder) {
    std::error_code ignored;
    for (const char* name : {"points3D.bin", "points3D.txt"}) {
        if (fs::is_regular_file(folder / name, ignored)) return {};
    }
    return Error{ErrorCode::kNotFound,
                 folder.string() + " has no points3D.bin or points3D.txt: copy the whole model"};
}

Result<void> check_geometry(const ExportedModel& model, const fs::path& folder) {
    if (auto checked = check_depths(model, folder); !checked.ok()) return checked.error();
    return check_projections(model, folder);
}

void tell_of_spare_cameras(const ExportedModel& model) {
    std::set<std::uint32_t> used;
    for (const ExportedImage& image : model.images) used.insert(image.camera_id);
    const std::size_t spare = model.cameras.size() - used.size();
    if (spare == 0) return;
    std::cerr << "psfm: " << counted(spare, "camera") << " of the model "
              << (spare == 1 ? "is" : "are") << " left out: no image has "
              << (spare == 1 ? "it" : "them") << '\n';
}

}  // namespace psfm
