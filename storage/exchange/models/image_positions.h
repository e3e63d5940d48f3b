// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "storage/exchange/files/output_file.h"
#include "storage/exchange/models/exported_model.h"

namespace psfm {

/// An observation by the position of its image in the model's list, as formats without ids count.
struct PlacedObservation {
    std::uint64_t image_position = 0;
    std::uint64_t keypoint = 0;
    const ExportedKeypoint* pixel = nullptr;
};

/// The observations of a point whose images carry keypoints, at most one an image.
inline std::vector<PlacedObservation> placed_observations(const ExportedModel& model,
                                                          const ExportedPoint& point) {
    std::vector<PlacedObservation> result;
    for (const ExportedObservation& observation : point.track) {
        const ExportedImage* image = model.find_image(observation.image_id);
        if (image == nullptr || observation.keypoint >= image->keypoints.size()) continue;
        const auto position = static_cast<std::uint64_t>(image - model.images.data());
        if (std::ranges::find(result, position, &PlacedObservation::image_position) !=
            result.end()) {
            continue;
        }
        result.push_back({position, observation.keypoint, &image->keypoints[observation.keypoint]});
    }
    return result;
}

/// Which way a format has the y of its images point.
enum class ImageY : std::uint8_t { kDown, kUp };

/// The number of a point's placed observations; of each the image's position, the keypoint, and
/// where it is from its camera's principal point [px], as NVM and Bundler have them.
inline void write_measurements(const ExportedModel& model, const ExportedPoint& point, ImageY y,
                               OutputFile& file) {
    const auto observations = placed_observations(model, point);
    file.numbers(observations.size());
    for (const PlacedObservation& observation : observations) {
        const ExportedImage& image = model.images[observation.image_position];
        const Eigen::Vector2d centre = model.find_camera(image.camera_id)->camera.principal_point();
        const ExportedKeypoint& pixel = *observation.pixel;
        file.numbers(observation.image_position, observation.keypoint, pixel.x - centre.x(),
                     y == ImageY::kDown ? pixel.y - centre.y() : centre.y() - pixel.y);
    }
}

/// Radial distortion k1, k2 of a camera; zero where its model has none.
inline std::array<double, 2> radial_distortion(const Camera& camera) {
    switch (camera.model) {
        case CameraModel::kSimplePinhole:
        case CameraModel::kPinhole:
            return {0.0, 0.0};
        case CameraModel::kSimpleRadial:
            return {camera.params[3], 0.0};
        case CameraModel::kRadial:
            return {camera.params[3], camera.params[4]};
        case CameraModel::kOpenCv:
            return {camera.params[4], camera.params[5]};
    }
    return {0.0, 0.0};
}

/// The one coefficient that comes nearest to both, over the circle around the photograph: k that
/// minimises the integral of (k r^3 - k1 r^3 - k2 r^5)^2 over its area.
inline double single_radial_distortion(const Camera& camera) {
    const auto [k1, k2] = radial_distortion(camera);
    const double radius = 0.5 * std::hypot(camera.width, camera.height) / camera.mean_focal();
    return k1 + 0.8 * k2 * radius * radius;
}

}  // namespace psfm
