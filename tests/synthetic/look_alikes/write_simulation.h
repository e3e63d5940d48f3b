// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>

#include "graph/result.h"
#include "tests/synthetic/look_alikes/look_alike_pairs.h"
#include "tests/synthetic/look_alikes/look_alike_scene.h"

namespace psfm::synthetic {

struct SimulationOptions {
    LookAlikeMatchOptions matches = {};
    /// Of the cameras in the database, relative; temple-341's EXIF is 0.4 to 0.9 % off.
    double focal_error = 0.005;
    /// Matches further from what their pair tells are left out, as verification does: COLMAP's 4
    /// px.
    double max_error_px = 4.0;
};

Result<void> validate(const SimulationOptions& options);

struct SimulationSummary {
    std::size_t images = 0, features = 0;
    std::size_t pairs = 0;    ///< in the database
    std::size_t folded = 0;   ///< of these, pairs whose geometry is that of a look-alike
    std::size_t matches = 0;  ///< in the database
};

/// Writes a scene as another program's matches and what came of them: FOLDER/database.db (COLMAP's
/// format: features without descriptors, cameras as if from EXIF, verified pairs),
/// FOLDER/reference/{cameras,images,points3D}.txt (true cameras and poses) and FOLDER/order.txt
/// (the scene's order of arrival, one name a line); of streets, FOLDER/districts.txt (the order by
/// district). Existing files of these names are replaced.
/// Pairs are made image by image, so that they are never all in memory.
/// @errors kInvalidArgument (options), kIo and those of ColmapDatabaseWriter, which name the file
Result<SimulationSummary> write_simulation(const LookAlikeScene& scene,
                                           const SimulationOptions& options,
                                           const std::filesystem::path& folder);

}  // namespace psfm::synthetic
