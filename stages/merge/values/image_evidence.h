// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "graph/ids.h"
#include "graph/image.h"

namespace psfm {

/// What a photograph's file tells of where the camera was, and which way up.
struct ImageEvidence {
    ImageId image{};
    std::optional<GpsPosition> gps;
    std::uint8_t orientation = 1;  ///< EXIF, 1..8: see up_in_camera
};

/// @param images  of the session, ascending by id
/// @return one an image, ascending
std::vector<ImageEvidence> evidence_of(std::span<const Image> images);

/// Binary search; nullptr when there is none.
const ImageEvidence* find_evidence(std::span<const ImageEvidence> evidence, ImageId image);

/// Whether a position can be meant: finite, a latitude within ±90° and a longitude within ±180°,
/// and not exactly 0, 0, which cameras write that have no fix.
bool is_plausible(const GpsPosition& position);

/// Origin of a session's east-north-up frame: the plausible position of its first image among those
/// that agree with others (docs/georeferencing.md, "The datum"). Deterministic.
/// @param parts  images that stand in one model, each; their positions cannot be in several places,
///     and those that fewer of a part's images have are passed over
/// @return with altitude 0 where that image has none; empty without any position
std::optional<GpsPosition> datum_of(std::span<const ImageEvidence> evidence,
                                    std::span<const std::vector<ImageId>> parts);

/// Position [m] in the frame that touches the WGS 84 ellipsoid at the datum's height above it:
/// x east, y north, z up. Straight, not along the ground: 100 km away "up" has turned by 0.9°.
/// Altitudes are taken as heights above the ellipsoid, though EXIF means the sea: both are a
/// constant apart that cancels. A position without altitude is taken at the datum's.
/// REQUIRES: is_plausible of both
Eigen::Vector3d enu_from_wgs84(const GpsPosition& datum, const GpsPosition& position);

}  // namespace psfm
