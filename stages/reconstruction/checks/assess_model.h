// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "graph/reconstruction.h"
#include "graph/two_view_geometry.h"
#include "graph/weakness.h"
#include "stages/reconstruction/model/assessment_options.h"

namespace psfm {

/// Whether edges between a model's images are known to be mere turns of the camera, and the model
/// shows them as steps: photographs from one place have no depth, and one was made up that explains
/// them (a turn past something far looks like a step past something near).
/// @param edges  of the model's images; others are passed over
bool has_invented_depth(const Reconstruction& model, std::span<const VerifiedPairPtr> edges,
                        const AssessmentOptions& options);

/// Images in parts of a model that hang on the largest one by a handful of points: they may swing
/// about these. @param smallest_part  smaller parts are passed over: an image that was hard to
/// place is no hinge. Cost: once through its observations.
std::size_t loose_images(const Reconstruction& model, std::size_t smallest_part,
                         const AssessmentOptions& options);

/// Why a model is weak; nothing for an empty one. Cost: once through its observations.
Weaknesses weaknesses_of(const Reconstruction& model, const AssessmentOptions& options);

}  // namespace psfm
