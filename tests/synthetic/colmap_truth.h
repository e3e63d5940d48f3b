// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "graph/result.h"
#include "tests/synthetic/render.h"

namespace psfm::synthetic {

/// Writes cameras.txt, images.txt and points3D.txt of COLMAP's text format: one camera with id 1,
/// images from 1, poses cam_from_world, no points. Numbers round-trip exactly.
/// @errors kIo (names the file)
Result<void> write_colmap_truth(const PhotoPlan& plan, const std::filesystem::path& folder);

}  // namespace psfm::synthetic
