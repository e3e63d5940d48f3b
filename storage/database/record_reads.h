// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "storage/database/read_view.h"
#include "storage/records/cluster_records.h"
#include "storage/records/scene_records.h"

// Internal: single records out of a view.

namespace psfm {

/// Records in a family whose keys are 0 … n-1. @return n
Result<std::uint32_t> count_images(const ReadView& view, Family family);

/// All clusters, tombstones too.
Result<std::map<ClusterId, ClusterRecord>> read_clusters(const ReadView& view);

Result<std::set<CameraId>> read_camera_ids(const ReadView& view);
Result<SupersededSolutions> read_superseded(const ReadView& view);
Result<std::optional<SceneRecord>> read_latest_scene(const ReadView& view);

/// The last version with at most `image_count` images.
Result<std::optional<SceneRecord>> read_scene_after(const ReadView& view,
                                                    std::uint32_t image_count);

/// All versions that are kept, the oldest first.
Result<std::vector<PastVersion>> read_versions(const ReadView& view);

}  // namespace psfm
