// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/two_view_geometry.h"

namespace psfm {

/// The same geometry with the images' roles exchanged: inverse pose, transposed E or F, inverse H,
/// matches exchanged and sorted anew. An involution up to rounding. Thread-safe.
TwoViewGeometry invert(const TwoViewGeometry& geometry);

}  // namespace psfm
