// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/values/image_evidence.h"

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/union_find.h"

namespace psfm {
namespace {

/// Guard: keeps a wrong fix from becoming the origin [m]. Lowered: walks with gaps fall apart into
/// places of their own; raised: wrong fixes further off count as right, which puts the origin that
/// far away and does no other harm.
constexpr double kNearM = 10'000.0;

bool are_near(const GpsPosition& one, const GpsPosition& other) {
    // Mathematics: the Earth's circumference over 360.
    constexpr double kMetresPerDegree = 111'000.0;
    const double north = (one.latitude_deg - other.latitude_deg) * kMetresPerDegree;
    const double across = std::remainder(one.longitude_deg - other.longitude_deg, 360.0);
    const double east =
        across * kMetresPerDegree * std::cos(radians_from_degrees(one.latitude_deg));
    return std::hypot(north, east) <= kNearM;
}

/// Cells of 10 km that touch one another hold one group of positions.
class Groups {
  public:
    void add(const GpsPosition& position) {
        Eigen::Vector3d place;
        GeographicLib::Geocentric::WGS84().Forward(position.latitude_deg, position.longitude_deg,
                                                   0.0, place.x(), place.y(), place.z());
        const Cell cell = {std::lround(place.x() / kNearM), std::lround(place.y() / kNearM),
                           std::lround(place.z() / kNearM)};
        const auto [known, added] = number_.try_emplace(cell, sets_.size());
        of_position_.push_back(known->second);
        if (!added) return;
        sets_.add();
        for (long x = -1; x <= 1; ++x) {
            for (long y = -1; y <= 1; ++y) {
                for (long z = -1; z <= 1; ++z) {
                    const auto next = number_.find({cell[0] + x, cell[1] + y, cell[2] + z});
                    if (next != number_.end()) sets_.join(next->second, known->second);
                }
            }
        }
    }

    /// The earliest position whose group has half as many as the largest one.
    std::size_t first_of_large() {
        std::map<std::size_t, std::size_t> count;
        for (const std::size_t cell : of_position_) ++count[sets_.root_of(cell)];
        std::size_t largest = 0;
        for (const auto& [group, positions] : count) largest = std::max(largest, positions);
        for (std::size_t k = 0; k < of_position_.size(); ++k) {
            if (2 * count[sets_.root_of(of_position_[k])] >= largest) return k;
        }
        return 0;
    }

  private:
    using Cell = std::array<long, 3>;

    std::map<Cell, std::size_t> number_;
    UnionFind<std::size_t> sets_;           // of cells
    std::vector<std::size_t> of_position_;  // its cell
};

/// REQUIRES: there is a plausible position
const ImageEvidence* first_of_agreeing(std::span<const ImageEvidence> evidence) {
    std::vector<const ImageEvidence*> located;
    Groups groups;
    for (const ImageEvidence& image : evidence) {
        if (!image.gps || !is_plausible(*image.gps)) continue;
        located.push_back(&image);
        groups.add(*image.gps);
    }
    return located[groups.first_of_large()];
}

}  // namespace

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
    constexpr double kPole = 90.0;       // Mathematics: where latitudes end
    constexpr double kDateLine = 180.0;  // Mathematics: where longitudes end
    // Comparisons with NaN are false.
    return std::abs(position.latitude_deg) <= kPole &&
           std::abs(position.longitude_deg) <= kDateLine &&
           (position.latitude_deg != 0.0 || position.longitude_deg != 0.0) &&
           std::isfinite(position.altitude_m.value_or(0.0));
}

std::optional<GpsPosition> datum_of(std::span<const ImageEvidence> evidence) {
    const ImageEvidence* chosen = nullptr;
    std::size_t positions = 0;
    std::size_t near_first = 0;
    for (const ImageEvidence& image : evidence) {
        if (!image.gps || !is_plausible(*image.gps)) continue;
        if (chosen == nullptr) chosen = &image;
        ++positions;
        if (are_near(*chosen->gps, *image.gps)) ++near_first;
    }
    if (chosen == nullptr) return std::nullopt;
    // With a third of all positions near the first, no group has more than twice as many.
    if (3 * near_first < positions) chosen = first_of_agreeing(evidence);
    GpsPosition datum = *chosen->gps;
    datum.altitude_m = datum.altitude_m.value_or(0.0);
    return datum;
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
