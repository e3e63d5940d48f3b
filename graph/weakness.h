// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace psfm {

/// Why a model is not to be trusted far, though it is one (bits, persistent).
enum class Weakness : std::uint8_t {
    kSmallAngles = 0,       ///< its points are seen from hardly different directions
    kFewPoints = 1,         ///< its images see few points
    kThinJoint = 2,         ///< parts of it hang together by a handful of points
    kImplausibleFocal = 3,  ///< a focal length that no camera has, or that others of its size lack
    kLookAlikes = 4,        ///< its images should see what they do not: two things may be one in it
};
constexpr std::uint32_t kWeaknessCount = 5;  // Format: bits of Weaknesses that mean something

/// A set of them.
struct Weaknesses {
    std::uint32_t bits = 0;

    void add(Weakness weakness) { bits |= 1U << static_cast<std::uint32_t>(weakness); }
    bool has(Weakness weakness) const {
        return (bits >> static_cast<std::uint32_t>(weakness) & 1U) != 0;
    }
    bool none() const { return bits == 0; }
    bool operator==(const Weaknesses&) const = default;
};

/// A word for programs: "small_angles".
const char* name_of(Weakness weakness);
/// What is wrong and what helps, for people.
const char* describe(Weakness weakness);
/// Those of a set, in the order of the enumeration; bits of a newer program are passed over.
std::vector<Weakness> list_of(const Weaknesses& weaknesses);

}  // namespace psfm
