// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graph/result.h"
#include "graph/two_view_geometry.h"

namespace psfm {

/// Payload of the pairs that were committed with one image (FORMAT.md section 4).
/// @param pairs  (other, image) with other < image, ascending by other, none null
/// @errors kInvalidArgument (breaks an invariant of VerifiedPair)
Result<std::string> encode_pairs(ImageId image, const std::vector<VerifiedPairPtr>& pairs);

/// @errors kDamaged
Result<std::vector<VerifiedPairPtr>> decode_pairs(ImageId image, std::string_view payload);

}  // namespace psfm
