// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "graph/result.h"

namespace psfm {

/// Camera models by COLMAP's names and numbers (persistent: the numbers are stored).
enum class CameraModel : std::uint8_t {
    kSimplePinhole = 0,  ///< f, cx, cy
    kPinhole = 1,        ///< fx, fy, cx, cy
    kSimpleRadial = 2,   ///< f, cx, cy, k
    kRadial = 3,         ///< f, cx, cy, k1, k2
    kOpenCv = 4,         ///< fx, fy, cx, cy, k1, k2, p1, p2
};

/// How much is known of the intrinsics (persistent).
enum class FocalSource : std::uint8_t {
    kUnknown = 0,   ///< a guess; to be estimated
    kExif = 1,      ///< from EXIF or Lensfun: good to a few per cent, refined
    kGiven = 2,     ///< given by the user (--cameras): refined unless --fix-intrinsics
    kEstimated = 3  ///< estimated by an earlier reconstruction of the session
};

/// Intrinsics of one physical camera. Pixels; origin at the top-left corner of the top-left pixel,
/// so the centre of that pixel is (0.5, 0.5). Parameters in the order of CameraModel's comments.
/// Invariants: width, height > 0; params beyond parameter_count(model) are 0; focal lengths > 0.
struct Camera {
    CameraModel model = CameraModel::kSimpleRadial;
    std::uint32_t width = 0;   ///< [px]
    std::uint32_t height = 0;  ///< [px]
    std::array<double, 8> params{};
    FocalSource focal_source = FocalSource::kUnknown;

    double fx() const { return params[0]; }
    double fy() const;
    double mean_focal() const { return 0.5 * (fx() + fy()); }
    Eigen::Vector2d principal_point() const;
    bool has_two_focals() const {
        return model == CameraModel::kPinhole || model == CameraModel::kOpenCv;
    }
    /// Intrinsic matrix without distortion.
    Eigen::Matrix3d matrix() const;
    bool operator==(const Camera&) const = default;
};

int parameter_count(CameraModel model);
std::string_view model_name(CameraModel model);
std::optional<CameraModel> model_from_name(std::string_view name);

/// SIMPLE_RADIAL with the given focal length [px], centred principal point and no distortion.
Camera make_camera(std::uint32_t width, std::uint32_t height, double focal_px, FocalSource source);

/// Pixel of a point in camera coordinates; nothing when it is not in front of the camera.
std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& point_in_cam);

/// Pixel of normalised (z = 1) coordinates, distortion applied.
Eigen::Vector2d pixel_from_normalized(const Camera& camera, const Eigen::Vector2d& normalized);

/// Normalised (z = 1) coordinates of a pixel, distortion removed by fixed-point and Newton
/// iterations.
Eigen::Vector2d normalized_from_pixel(const Camera& camera, const Eigen::Vector2d& pixel);

/// Checks the invariants: sizes, finite values, focal lengths between 0.1 and 100 image diagonals.
Result<void> validate(const Camera& camera);

}  // namespace psfm
