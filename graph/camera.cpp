// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/camera.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace psfm {
namespace {

struct ModelInfo {
    CameraModel model;
    std::string_view name;
    int parameters;
};

/// Format: models as COLMAP numbers and names them, and how many parameters each has.
constexpr std::array<ModelInfo, 5> kModels{{{CameraModel::kSimplePinhole, "SIMPLE_PINHOLE", 3},
                                            {CameraModel::kPinhole, "PINHOLE", 4},
                                            {CameraModel::kSimpleRadial, "SIMPLE_RADIAL", 4},
                                            {CameraModel::kRadial, "RADIAL", 5},
                                            {CameraModel::kOpenCv, "OPENCV", 8}}};

/// Distorted minus undistorted normalised coordinates.
Eigen::Vector2d distortion_offset(const Camera& camera, const Eigen::Vector2d& x) {
    const double r2 = x.squaredNorm();
    switch (camera.model) {
        case CameraModel::kSimplePinhole:
        case CameraModel::kPinhole:
            return Eigen::Vector2d::Zero();
        case CameraModel::kSimpleRadial:
            return x * (camera.params[3] * r2);
        case CameraModel::kRadial:
            return x * (camera.params[3] * r2 + camera.params[4] * r2 * r2);
        case CameraModel::kOpenCv: {
            const double radial = camera.params[4] * r2 + camera.params[5] * r2 * r2;
            const double p1 = camera.params[6];
            const double p2 = camera.params[7];
            const double xy = x.x() * x.y();
            return x * radial + Eigen::Vector2d(2 * p1 * xy + p2 * (r2 + 2 * x.x() * x.x()),
                                                2 * p2 * xy + p1 * (r2 + 2 * x.y() * x.y()));
        }
    }
    return Eigen::Vector2d::Zero();
}

}  // namespace

double Camera::fy() const {
    return has_two_focals() ? params[1] : params[0];
}

Eigen::Vector2d Camera::principal_point() const {
    return has_two_focals() ? Eigen::Vector2d(params[2], params[3])
                            : Eigen::Vector2d(params[1], params[2]);
}

Eigen::Matrix3d Camera::matrix() const {
    const Eigen::Vector2d centre = principal_point();
    Eigen::Matrix3d k;
    k << fx(), 0, centre.x(), 0, fy(), centre.y(), 0, 0, 1;
    return k;
}

int parameter_count(CameraModel model) {
    return kModels.at(static_cast<std::size_t>(model)).parameters;
}

std::string_view model_name(CameraModel model) {
    return kModels.at(static_cast<std::size_t>(model)).name;
}

std::optional<CameraModel> model_from_name(std::string_view name) {
    const auto* found = std::ranges::find(kModels, name, &ModelInfo::name);
    if (found == kModels.end()) return std::nullopt;
    return found->model;
}

Camera make_camera(std::uint32_t width, std::uint32_t height, double focal_px, FocalSource source) {
    Camera camera;
    camera.model = CameraModel::kSimpleRadial;
    camera.width = width;
    camera.height = height;
    camera.params = {focal_px, 0.5 * width, 0.5 * height, 0.0};
    camera.focal_source = source;
    return camera;
}

Eigen::Vector2d pixel_from_normalized(const Camera& camera, const Eigen::Vector2d& normalized) {
    const Eigen::Vector2d distorted = normalized + distortion_offset(camera, normalized);
    return camera.principal_point() +
           Eigen::Vector2d(camera.fx() * distorted.x(), camera.fy() * distorted.y());
}

std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& point_in_cam) {
    if (point_in_cam.z() < 1e-9) return std::nullopt;
    return pixel_from_normalized(camera, point_in_cam.hnormalized());
}

Eigen::Vector2d normalized_from_pixel(const Camera& camera, const Eigen::Vector2d& pixel) {
    const Eigen::Vector2d offset = pixel - camera.principal_point();
    const Eigen::Vector2d distorted(offset.x() / camera.fx(), offset.y() / camera.fy());
    if (camera.model == CameraModel::kSimplePinhole || camera.model == CameraModel::kPinhole)
        return distorted;
    // Newton with a numerical Jacobian: distortion is smooth, and two to four steps reach 1e-12.
    Eigen::Vector2d x = distorted;
    for (int iteration = 0; iteration < 20; ++iteration) {
        const Eigen::Vector2d residual = x + distortion_offset(camera, x) - distorted;
        if (residual.squaredNorm() < 1e-24) break;
        // Mathematics: of central differences of numbers about 1, where rounding and curvature err
        // by 1e-10.
        constexpr double kStep = 1e-6;
        Eigen::Matrix2d jacobian = Eigen::Matrix2d::Identity();
        for (int axis = 0; axis < 2; ++axis) {
            const Eigen::Vector2d step = Eigen::Vector2d::Unit(axis) * kStep;
            jacobian.col(axis) +=
                (distortion_offset(camera, x + step) - distortion_offset(camera, x - step)) /
                (2 * kStep);
        }
        if (std::abs(jacobian.determinant()) < 1e-6) break;
        x -= jacobian.inverse() * residual;
    }
    return x;
}

Result<void> validate(const Camera& camera) {
    if (camera.width == 0 || camera.height == 0) {
        return Error{ErrorCode::kInvalidArgument, "camera has no size"};
    }
    if (static_cast<std::size_t>(camera.model) >= kModels.size()) {
        return Error{ErrorCode::kInvalidArgument, "camera model is not one of psfm's"};
    }
    if (!std::ranges::all_of(camera.params, [](double p) { return std::isfinite(p); })) {
        return Error{ErrorCode::kInvalidArgument, "camera parameters are not finite"};
    }
    const double diagonal = std::hypot(camera.width, camera.height);
    for (const double focal : {camera.fx(), camera.fy()}) {
        if (focal < 0.1 * diagonal || focal > 100 * diagonal) {
            return Error{ErrorCode::kInvalidArgument,
                         "focal length " + std::to_string(focal) +
                             " px is outside 0.1 to 100 image diagonals"};
        }
    }
    return {};
}

}  // namespace psfm
