// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/values/image_evidence.h"

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/union_find.h"

namespace psfm {
namespace {

/// Guard: keeps a wrong fix from becoming the origin [m]: which
/// position that is, and which are outvoted, is all that depends on it. Chosen, not measured.
/// Lowered: walks with gaps fall apart into places of their own; raised: wrong fixes further off
/// count as right, which puts the origin that far away and does no other harm.
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

    /// Of each group how many positions it has.
    std::map<std::size_t, std::size_t> sizes() {
        std::map<std::size_t, std::size_t> count;
        for (const std::size_t cell : of_position_) ++count[sets_.root_of(cell)];
        return count;
    }
    std::size_t group_of(std::size_t position) { return sets_.root_of(of_position_[position]); }

  private:
    using Cell = std::array<long, 3>;

    std::map<Cell, std::size_t> number_;
    UnionFind<std::size_t> sets_;           // of cells
    std::vector<std::size_t> of_position_;  // its cell
};

using Located = std::vector<const ImageEvidence*>;

Groups groups_of(const Located& located) {
    Groups groups;
    for (const ImageEvidence* image : located) groups.add(*image->gps);
    return groups;
}

std::size_t size_of_largest(const std::map<std::size_t, std::size_t>& sizes) {
    return std::ranges::max_element(sizes, {}, [](const auto& size) { return size.second; })
        ->second;
}

bool are_near_the_first(const Located& located) {
    return std::ranges::all_of(located, [&](const ImageEvidence* image) {
        return are_near(*located.front()->gps, *image->gps);
    });
}

/// The first one whose group has half as many as the largest one. REQUIRES: there is one
const ImageEvidence* first_of_agreeing(const Located& located) {
    const auto near_first = std::ranges::count_if(located, [&](const ImageEvidence* image) {
        return are_near(*located.front()->gps, *image->gps);
    });
    // With a third of all positions near the first, no group has more than twice as many.
    if (3 * static_cast<std::size_t>(near_first) >= located.size()) return located.front();
    Groups groups = groups_of(located);
    const auto sizes = groups.sizes();
    const std::size_t largest = size_of_largest(sizes);
    std::size_t first = 0;
    while (2 * sizes.at(groups.group_of(first)) < largest) ++first;
    return located[first];
}

/// Adds the images of a part whose positions are not where most of its positions are.
void add_outvoted(const Located& part, std::set<ImageId>& outvoted) {
    if (part.empty() || are_near_the_first(part)) return;
    Groups groups = groups_of(part);
    const auto sizes = groups.sizes();
    const std::size_t largest = size_of_largest(sizes);
    std::size_t chosen = 0;  // of several largest ones that of the earliest image
    while (sizes.at(groups.group_of(chosen)) < largest) ++chosen;
    for (std::size_t k = 0; k < part.size(); ++k) {
        if (groups.group_of(k) != groups.group_of(chosen)) outvoted.insert(part[k]->image);
    }
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

std::optional<GpsPosition> datum_of(std::span<const ImageEvidence> evidence,
                                    std::span<const std::vector<ImageId>> parts) {
    const auto is_located = [](const ImageEvidence& image) {
        return image.gps && is_plausible(*image.gps);
    };
    std::set<ImageId> outvoted;
    for (const std::vector<ImageId>& part : parts) {
        Located located;
        for (const ImageId image : part) {
            const ImageEvidence* found = find_evidence(evidence, image);
            if (found != nullptr && is_located(*found)) located.push_back(found);
        }
        std::ranges::sort(located, {}, &ImageEvidence::image);
        add_outvoted(located, outvoted);
    }
    Located located;
    for (const ImageEvidence& image : evidence) {
        if (is_located(image) && !outvoted.contains(image.image)) located.push_back(&image);
    }
    if (located.empty()) return std::nullopt;
    GpsPosition datum = *first_of_agreeing(located)->gps;
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
