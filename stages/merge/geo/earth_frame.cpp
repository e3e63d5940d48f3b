// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/geo/earth_frame.h"

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <vector>

namespace psfm {

GpsPosition wgs84_from_enu(const GpsPosition& datum, const Eigen::Vector3d& enu) {
    const GeographicLib::LocalCartesian frame(datum.latitude_deg, datum.longitude_deg,
                                              datum.altitude_m.value_or(0.0));
    GpsPosition position;
    double altitude = 0.0;
    frame.Reverse(enu.x(), enu.y(), enu.z(), position.latitude_deg, position.longitude_deg,
                  altitude);
    position.altitude_m = altitude;
    return position;
}

Eigen::Matrix4d ecef_from_enu(const GpsPosition& datum) {
    Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
    std::vector<double> rotation;  // row by row
    rotation.resize(9);
    GeographicLib::Geocentric::WGS84().Forward(datum.latitude_deg, datum.longitude_deg,
                                               datum.altitude_m.value_or(0.0), result(0, 3),
                                               result(1, 3), result(2, 3), rotation);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            result(row, column) = rotation[static_cast<std::size_t>(3 * row + column)];
    }
    return result;
}

}  // namespace psfm
