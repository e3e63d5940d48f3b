// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"
#include "graph/two_view_geometry.h"
#include "stages/verification/two_view_problem.h"
#include "stages/verification/verify_options.h"

namespace psfm {

/// verify_pair with no regard to which of the matches move: the part of it that estimates.
/// @return TwoViewGeometry::still is empty, and its densities are not known. Else as verify_pair
Result<TwoViewGeometry> verify_matches(const MatchedViews& views, const VerifyOptions& options,
                                       std::uint64_t seed);

}  // namespace psfm
