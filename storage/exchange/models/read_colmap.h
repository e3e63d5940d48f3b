// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "graph/result.h"
#include "storage/exchange/models/exported_model.h"

namespace psfm {

/// Which parts of a COLMAP model are read. Everything by default; evaluation needs poses only, and
/// then camera models that psfm does not have are no obstacle.
struct ColmapReadOptions {
    bool cameras = true;    ///< false: the cameras file is not opened, camera ids are not checked
    bool keypoints = true;  ///< false: features are parsed and checked, but not kept
    bool points = true;     ///< false: the points file is not opened
};

/// Reads a COLMAP model (3.8's layout, which 4.x keeps), binary when images.bin is there, else
/// text. A missing points file means no points, since references made from known poses often lack
/// it. Every count is checked against the file's size before anything is allocated, every number
/// against its range, and features, tracks and cameras against each other. Names are relative paths
/// without "..", of UTF-8 without control characters.
/// @return the model, its lists ascending by id; focal_source is kGiven
/// @errors kNotFound (no model in the folder), kUnreadable, kInvalidArgument (a camera model that
/// psfm
///         does not have), kDamaged (names the file and the line or the byte offset)
/// Thread-safe.
Result<ExportedModel> read_colmap_model(const std::filesystem::path& folder,
                                        const ColmapReadOptions& options = {});

/// Whether the folder itself holds images.bin or images.txt.
bool is_colmap_model(const std::filesystem::path& folder);

/// The folder itself when it is a model, else its sub-folders 0, 1, … that are, in that order.
/// @errors kNotFound when there is none
Result<std::vector<std::filesystem::path>> find_colmap_models(const std::filesystem::path& folder);

}  // namespace psfm
