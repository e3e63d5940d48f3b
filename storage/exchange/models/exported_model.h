// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "graph/camera.h"
#include "graph/image_source.h"
#include "graph/rigid3.h"

namespace psfm {

/// Marks a feature that no point uses. COLMAP writes the same value (its text files: -1).
inline constexpr std::uint64_t kNoPoint = std::numeric_limits<std::uint64_t>::max();

struct ExportedCamera {
    std::uint32_t id = 0;
    Camera camera;
    bool operator==(const ExportedCamera&) const = default;
};

/// A feature and the point it is an observation of.
struct ExportedKeypoint {
    double x = 0.0;  ///< [px], origin at the top-left corner of the top-left pixel
    double y = 0.0;
    std::uint64_t point = kNoPoint;
    bool operator==(const ExportedKeypoint&) const = default;
};

struct ExportedImage {
    std::uint32_t id = 0;
    std::uint32_t camera_id = 0;
    std::string name;  ///< relative to the photograph folder, '/' between parts
    Rigid3 cam_from_world;
    std::vector<ExportedKeypoint> keypoints;  ///< all features of the image, or none at all
};

/// Feature `keypoint` of the image with this id.
struct ExportedObservation {
    std::uint32_t image_id = 0;
    std::uint32_t keypoint = 0;
    auto operator<=>(const ExportedObservation&) const = default;
};

struct ExportedPoint {
    std::uint64_t id = 0;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< in the model's world
    std::array<std::uint8_t, 3> rgb{};
    double error_px = 0.0;  ///< mean reprojection error
    std::vector<ExportedObservation> track;
};

/// The neutral form that every format is written from and read into: one model in one frame, in
/// COLMAP's terms (pixel origin at the corner, cam_from_world). Invariants: cameras, images and
/// points ascending by id, ids unique; every image's camera is there. Where images carry keypoints,
/// tracks and keypoints agree.
struct ExportedModel {
    std::vector<ExportedCamera> cameras;
    std::vector<ExportedImage> images;
    std::vector<ExportedPoint> points;

    /// Binary search; nullptr when there is none.
    const ExportedCamera* find_camera(std::uint32_t id) const;
    const ExportedImage* find_image(std::uint32_t id) const;
    const ExportedPoint* find_point(std::uint64_t id) const;
};

/// A model of a session that began with another program's, with the ids that images and cameras
/// had there: numbers 0, 1, … (our ids less one) get those of the lists, later ones what follows
/// the largest, and from COLMAP's largest id on those that the lists leave free. REQUIRES: the
/// lists ascend
ExportedModel renumbered(ExportedModel model, std::span<const std::uint32_t> image_ids,
                         std::span<const std::uint32_t> camera_ids);

/// Adds what places of features lack as floats (ImageSource::place_remainders).
/// @param sources  of the images by number, which is their id less one
void add_remainders(ExportedModel& model, std::span<const ImageSource> sources);

/// Adds observations of points that another feature of the same image observes, where that feature
/// still does and the one beside it observes nothing.
/// @param repeated  three numbers each: the image's number (its id less one), the feature that
/// observes the point, the one beside it; what does not fit is left out
void add_repeated(ExportedModel& model, std::span<const std::uint32_t> repeated);

}  // namespace psfm
