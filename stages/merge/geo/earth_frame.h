// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "graph/image.h"

namespace psfm {

/// WGS 84 position, with altitude, of a place in the frame about a datum [m]: the inverse of
/// enu_from_wgs84. Thread-safe.
GpsPosition wgs84_from_enu(const GpsPosition& datum, const Eigen::Vector3d& enu);

/// From the frame about a datum to earth-centred, earth-fixed coordinates [m]. Rigid.
Eigen::Matrix4d ecef_from_enu(const GpsPosition& datum);

}  // namespace psfm
