// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "stages/algorithms/matching/descriptor_cells.h"
#include "stages/algorithms/matching/dot_kernel.h"
#include "stages/algorithms/matching/match_descriptors.h"

namespace psfm {

/// match_descriptors() with a kernel of the caller's choice: for tests and benchmarks.
/// REQUIRES: kernel is one of available_dot_kernels().
std::vector<FeatureMatch> match_with_kernel(const Descriptors& a, const PackedDescriptors& b,
                                            const MatchOptions& options, DotKernel kernel);
/// Likewise match_in_cells().
std::optional<std::vector<FeatureMatch>> match_in_cells_with_kernel(const Descriptors& a,
                                                                    const DescriptorCells& b,
                                                                    const MatchOptions& options,
                                                                    const CellOptions& cells,
                                                                    const NamedDotKernel& kernel);

}  // namespace psfm
