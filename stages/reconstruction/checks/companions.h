// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "graph/reconstruction.h"

namespace psfm {

/// By image of a model, the images with which it has most points in common, most first, as
/// positions in Reconstruction::images: they stand about it, and see what it sees. Where one image
/// misses a point by chance, one of its companions sees it. Of long tracks some images are counted.
/// @param count  at most so many of each, and at most a sixth of the model
/// Deterministic on any number of threads. Thread-safe. Cost: once through all observations.
std::vector<std::vector<std::uint32_t>> companions_of(const Reconstruction& model,
                                                      std::uint32_t count);

/// Where each image of a model stands in Reconstruction::images, by its id.
std::vector<std::uint32_t> positions_by_id(const Reconstruction& model);

}  // namespace psfm
