// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "graph/reconstruction.h"

namespace psfm::synthetic {

/// Replaces a model's points by what `change` makes of a copy of them.
template <typename Change>
void change_points(Reconstruction& model, const Change& change) {
    std::vector<ScenePoint> points = model.points.to_vector();
    change(points);
    model.points = std::move(points);
}

}  // namespace psfm::synthetic
