// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/sim3.h"

namespace psfm {

Sim3 operator*(const Sim3& c_from_b, const Sim3& b_from_a) {
    return {c_from_b.scale * b_from_a.scale, (c_from_b.rotation * b_from_a.rotation).normalized(),
            c_from_b * b_from_a.translation};
}

Sim3 inverse(const Sim3& target_from_source) {
    const Eigen::Quaterniond rotation = target_from_source.rotation.conjugate();
    const double scale = 1.0 / target_from_source.scale;
    return {scale, rotation, -scale * (rotation * target_from_source.translation)};
}

Rigid3 transform_pose(const Rigid3& cam_from_source, const Sim3& target_from_source) {
    Rigid3 cam_from_target;
    cam_from_target.rotation =
        (cam_from_source.rotation * target_from_source.rotation.conjugate()).normalized();
    const Eigen::Vector3d centre = target_from_source * cam_from_source.target_origin_in_source();
    cam_from_target.translation = -(cam_from_target.rotation * centre);
    return cam_from_target;
}

}  // namespace psfm
