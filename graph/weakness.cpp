// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/weakness.h"

namespace psfm {

const char* name_of(Weakness weakness) {
    switch (weakness) {
        case Weakness::kSmallAngles:
            return "small_angles";
        case Weakness::kFewPoints:
            return "few_points";
        case Weakness::kThinJoint:
            return "thin_joint";
        case Weakness::kImplausibleFocal:
            return "implausible_focal";
        case Weakness::kLookAlikes:
            return "look_alikes";
    }
    return "unknown";
}

const char* describe(Weakness weakness) {
    switch (weakness) {
        case Weakness::kSmallAngles:
            return "its points are seen from hardly different directions, so that depths are "
                   "vague; take photographs from further apart";
        case Weakness::kFewPoints:
            return "its photographs see few points in common; take more of them, with more overlap";
        case Weakness::kThinJoint:
            return "parts of it hang together by a handful of points and may be turned or scaled "
                   "against each other; take photographs between them";
        case Weakness::kImplausibleFocal:
            return "a focal length came out implausible; give it by --cameras, or "
                   "--camera-sharing all where one camera took them";
        case Weakness::kLookAlikes:
            return "some of its photographs should show what they do not: these could be two alike "
                   "objects; photographs between them would tell";
    }
    return "unknown";
}

std::vector<Weakness> list_of(const Weaknesses& weaknesses) {
    std::vector<Weakness> list;
    for (std::uint32_t bit = 0; bit < kWeaknessCount; ++bit) {
        const auto weakness = static_cast<Weakness>(bit);
        if (weaknesses.has(weakness)) list.push_back(weakness);
    }
    return list;
}

}  // namespace psfm
