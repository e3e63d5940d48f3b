// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "graph/sim3.h"
#include "stages/merge/geo/gravity.h"
#include "stages/merge/values/merge_options.h"

namespace psfm {

/// A camera of a component whose photograph has a position.
struct LocatedCamera {
    Eigen::Vector3d centre;     ///< in the component's frame
    Eigen::Vector3d enu;        ///< [m]; see enu_from_wgs84
    bool has_altitude = false;  ///< false: enu.z() says nothing
};

/// Cost of a similarity, in squared standard deviations: Cauchy's of each position, east-north and
/// altitude apart (either may be wrong alone), and Gaussian of gravity, which is robust by itself.
/// Where no altitude is known, the cameras' mean height is that of the datum.
/// @param gravity null: not asked
double position_cost(std::span<const LocatedCamera> cameras, const Gravity* gravity,
                     const Sim3& enu_from_component, const GeoreferenceOptions& options);

/// The similarity of least cost near `start`: Levenberg-Marquardt over its seven numbers about the
/// cameras' mean, with reweighting. Smooth in the positions: a new one moves the result by its
/// share.
/// REQUIRES: at least one camera
Sim3 fit_to_positions(std::span<const LocatedCamera> cameras, const Gravity* gravity,
                      const Sim3& start, const GeoreferenceOptions& options);

}  // namespace psfm
