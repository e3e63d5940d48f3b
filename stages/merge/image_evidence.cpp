// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/image_evidence.h"

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>

namespace psfm {

std::vector<ImageEvidence> evidence_of(std::span<const Image> images) {
    std::vector<ImageEvidence> evidence;
    evidence.reserve(images.size());
    for (const Image& image : images)
        evidence.push_back({image.id, image.metadata.gps, image.metadata.orientation});
    return evidence;
}

const ImageEvidence* find_evidence(std::span<const ImageEvidence> evidence, ImageId image) {
    const auto found = std::ranges::lower_bound(evidence, image, {}, &ImageEvidence::image);
    return found != evidence.end() && found->image == image ? &*found : nullptr;
}

bool is_plausible(const GpsPosition& position) {
    constexpr double kPole = 90.0;
    constexpr double kDateLine = 180.0;
    // Comparisons with NaN are false.
    return std::abs(position.latitude_deg) <= kPole &&
           std::abs(position.longitude_deg) <= kDateLine &&
           (position.latitude_deg != 0.0 || position.longitude_deg != 0.0) &&
           std::isfinite(position.altitude_m.value_or(0.0));
}

std::optional<GpsPosition> datum_of(std::span<const ImageEvidence> evidence) {
    for (const ImageEvidence& image : evidence) {
        if (!image.gps || !is_plausible(*image.gps)) continue;
        GpsPosition datum = *image.gps;
        datum.altitude_m = datum.altitude_m.value_or(0.0);
        return datum;
    }
    return std::nullopt;
}

Eigen::Vector3d enu_from_wgs84(const GpsPosition& datum, const GpsPosition& position) {
    const double ground = datum.altitude_m.value_or(0.0);
    const GeographicLib::LocalCartesian frame(datum.latitude_deg, datum.longitude_deg, ground);
    Eigen::Vector3d enu;
    frame.Forward(position.latitude_deg, position.longitude_deg,
                  position.altitude_m.value_or(ground), enu.x(), enu.y(), enu.z());
    return enu;
}

}  // namespace psfm
