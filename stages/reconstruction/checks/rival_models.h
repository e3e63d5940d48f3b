// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "graph/ids.h"
#include "stages/reconstruction/checks/judged_model.h"

namespace psfm {

/// What another model of the same cluster explains, and how well.
struct OtherModel {
    ModelScore score;
    std::vector<ModelEdge> edges;
};

/// Parts of a model that its rivals show in the same way. A rival is about as good, and explains
/// what the model denies and the other way round: images of two alike things, one of which they
/// show, and nothing tells which.
/// @param others  of the same images and edges; else they are no rivals
/// @return most images first; nothing where no rival shows anything else
std::vector<std::vector<ImageId>> parts_in_common(const Judged& best,
                                                  std::span<const OtherModel> others,
                                                  const DoubtOptions& options);

}  // namespace psfm
