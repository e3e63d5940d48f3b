// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "graph/result.h"
#include "tests/synthetic/photographs/render.h"
#include "tests/synthetic/scene.h"

namespace psfm::synthetic {

/// Writes cameras.txt, images.txt and points3D.txt of COLMAP's text format: one camera with id 1,
/// images from 1, poses cam_from_world, no points. Numbers round-trip exactly.
/// @errors kIo (names the file)
Result<void> write_colmap_truth(const PhotoPlan& plan, const std::filesystem::path& folder);

/// The same of a scene: camera c has id c + 1, image i id i + 1.
/// REQUIRES: as many names as images. @errors kIo (names the file)
Result<void> write_colmap_truth(const SyntheticScene& scene, std::span<const std::string> names,
                                const std::filesystem::path& folder);

}  // namespace psfm::synthetic
