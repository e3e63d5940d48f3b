// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/result.h"
#include "graph/two_view_geometry.h"

namespace psfm {

/// A match density that falls off exponentially with the triangulation angle, down to a floor.
/// Raised: doubt is cast on more pairs. Lowered: on fewer. Ours (docs/look-alikes.md, "Match
/// density").
struct ExpectedDensity {
    double at_zero = 0.0;  ///< for equal viewing directions
    double decay_deg = 0.0;
    double floor = 0.0;
};

/// How well a pair's matches fit two photographs of one place. Figures: docs/look-alikes.md.
struct PlausibilityOptions {
    /// Plausibilities count up to here. Raised: wide baselines are left out where images also have
    /// near-identical neighbours. Lowered: look-alikes stay in where everything matches well. Ours;
    /// not tuned.
    double max_plausibility = 4.0;
    /// Densities expected of two photographs of one place (see match_density); either will do.
    ExpectedDensity shared{.at_zero = 0.12, .decay_deg = 12.0, .floor = 0.01};
    ExpectedDensity core{.at_zero = 0.25, .decay_deg = 25.0, .floor = 0.12};
};

Result<void> validate(const PlausibilityOptions& options);

/// A pair's match density over the one expected of two photographs of one place at its
/// triangulation angle: around 2 for ordinary pairs, max_plausibility at most, and when the density
/// is unknown. Depends on nothing but the pair.
double plausibility(const TwoViewGeometry& geometry, const PlausibilityOptions& options);

}  // namespace psfm
