// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "stages/reconstruction/adjust/adjustment_problem.h"

namespace psfm {

/// Images of an adjustment in the order in which the factorisation of the reduced camera system
/// fills little: by approximate minimum degree (Amestoy, Davis & Duff 1996) of the graph of images
/// that see points together. Few images stay as they are: their system is dense anyway.
/// @param images  ascending; those that move
/// @param image_count  of the model
std::vector<std::uint32_t> elimination_order(const AdjustmentSelection& selection,
                                             std::vector<std::uint32_t> images,
                                             std::size_t image_count);

}  // namespace psfm
