// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "graph/result.h"
#include "graph/sim3.h"
#include "stages/merge/geo/fit_to_positions.h"
#include "stages/merge/geo/gravity.h"
#include "stages/merge/values/image_evidence.h"
#include "stages/merge/values/merge_options.h"

namespace psfm {

/// A camera with its position in the datum's frame; empty when the photograph has no plausible one.
std::optional<LocatedCamera> locate(const Eigen::Vector3d& centre, const ImageEvidence& evidence,
                                    const GpsPosition& datum);

/// How well positions agree with a place on the earth.
struct PositionAgreement {
    std::uint32_t positions = 0;  ///< cameras that have one
    /// Within three standard deviations east-north, and no worse in altitude.
    std::uint32_t inliers = 0;
    double median_m = 0.0;  ///< east-north distance of a camera to its position, over all
    double max_m = 0.0;
    /// Largest distance between two inliers' cameras [m], east-north (found by two sweeps: at least
    /// half of it in any case).
    double extent_m = 0.0;
    /// Standard deviation of heading [rad] and relative scale, as the inliers leave it: see
    /// GeoreferenceOptions::max_heading_sigma. Infinite without inliers.
    double heading_sigma = 0.0;
    /// Standard error of the cameras' places [m], root mean square: heading, scale and shift, four
    /// numbers from two a position, leave 2 sigma over the root of the inliers.
    double standard_error_m = 0.0;

    /// Whether there is enough evidence to call the place known.
    bool is_enough(const GeoreferenceOptions& options) const;
};
PositionAgreement agreement(std::span<const LocatedCamera> cameras, const Sim3& enu_from_component,
                            const GeoreferenceOptions& options);

/// The place of a component on the earth.
struct Georeference {
    Sim3 enu_from_component;
    PositionAgreement agreement;
    bool with_gravity = false;  ///< false: by positions alone, which lie in a plane or in space
};

/// Place of a component from its cameras' positions (paper sec. "Cluster Pose Estimation", last
/// paragraph, where it is a further constraint of the cluster pose graph; here a component that is
/// joined by vision is placed as a whole and never bent, as positions of phones are worse than
/// vision by two orders of magnitude).
///
/// Positions along a street leave the turn about the street open; gravity closes it. With gravity,
/// pairs of positions propose heading, scale and shift, otherwise triples propose a full similarity
/// (then positions on one line are too little evidence); the best by position_cost is refined over
/// all cameras. Gravity that the positions contradict (inliers below min_inlier_ratio with it) is
/// left out when they determine the place without it.
/// @param gravity  in the component's frame; empty: not known
/// @param before   where the component stands, tried first; empty: nowhere yet
/// @errors kDegenerate, with the reason: fewer than min_positions, most of them in disagreement, or
/// all so close to one another that heading or scale stay open
/// Deterministic. Thread-safe.
Result<Georeference> estimate_georeference(std::span<const LocatedCamera> cameras,
                                           const std::optional<Gravity>& gravity,
                                           const std::optional<Sim3>& before,
                                           const GeoreferenceOptions& options);

}  // namespace psfm
