// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/adjustment/reprojection.h"

#include <array>
#include <cstddef>

namespace psfm {

void write_pose(const Rigid3& cam_from_world, double* block) {
    Eigen::Map<Eigen::Vector4d>{block} = cam_from_world.rotation.coeffs();
    Eigen::Map<Eigen::Vector3d>{block + 4} = cam_from_world.translation;
}

Rigid3 read_pose(const double* block) {
    return {Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(block)).normalized(),
            Eigen::Map<const Eigen::Vector3d>(block + 4)};
}

PosedCamera::PosedCamera(CameraModel model, const double* pose, const double* intrinsics)
    : rotation(Eigen::Map<const Eigen::Quaterniond>(pose).toRotationMatrix()),
      translation(Eigen::Map<const Eigen::Vector3d>(pose + 4)) {
    focals = model == CameraModel::kPinhole || model == CameraModel::kOpenCv ? 2 : 1;
    distortions = parameter_count(model) - focals - 2;
    focal = {intrinsics[0], intrinsics[focals - 1]};
    centre = {intrinsics[focals], intrinsics[focals + 1]};
    const std::array<double*, 4> terms = {&k1, &k2, &p1, &p2};
    const double* bends = intrinsics + focals + 2;
    for (int i = 0; i < distortions; ++i) *terms.at(static_cast<std::size_t>(i)) = bends[i];
}

void Reprojection::derivatives(double scale, ReprojectionDerivatives& out) const {
    const Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_cam = by_point_in_cam(scale);
    // By w: a turn by w moves the turned point by w x point.
    for (int row = 0; row < 2; ++row) {
        const Eigen::Vector3d by = by_cam.row(row);
        out.by_pose.row(row) << rotated_.cross(by).transpose(), by.transpose();
    }
    out.by_point.noalias() = by_cam * camera_.rotation;
    auto& by = out.by_intrinsics;
    by.setZero();
    by(0, 0) = scale * bent_.x();
    by(1, camera_.focals - 1) = scale * bent_.y();
    by(0, camera_.focals) = scale;
    by(1, camera_.focals + 1) = scale;
    const Eigen::Vector2d focal = scale * camera_.focal;
    const std::array<Eigen::Vector2d, 4> bends = {r2_ * x_, r2_ * r2_ * x_, tangential1(),
                                                  tangential2()};
    for (int i = 0; i < camera_.distortions; ++i) {
        by.col(camera_.focals + 2 + i) = focal.cwiseProduct(bends.at(static_cast<std::size_t>(i)));
    }
}

}  // namespace psfm
