// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "stages/features/sift/find_places.h"

namespace psfm {

/// The order of features: scale descending, then y and x ascending.
bool comes_before(const SiftPlace& a, const SiftPlace& b);

/// Leaves max_features places at most, in order and without duplicates: the largest.
void choose_places(const SiftOptions& options, std::vector<SiftPlace>& places);

}  // namespace psfm
