// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "graph/rigid3.h"

namespace psfm {

/// A camera that evaluation knows by its photograph's name only: ids differ between programs.
struct NamedPose {
    std::string name;  ///< relative to the photograph folder, '/' between parts
    Rigid3 cam_from_world;
};

/// Positions in two lists that belong to the same photograph.
struct NameMatch {
    std::size_t reference = 0;
    std::size_t model = 0;
};

/// Pairs the photographs of two lists: by their whole relative name first; what is left, by the
/// last part of the name where that part is unique in both lists. One to one. REQUIRES: names are
/// unique within each list
/// @return ascending by the reference's name, so that nothing computed from it depends on the
/// lists' order Deterministic. Thread-safe.
std::vector<NameMatch> match_by_name(std::span<const NamedPose> reference,
                                     std::span<const NamedPose> model);

}  // namespace psfm
