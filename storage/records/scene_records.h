// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graph/result.h"
#include "storage/records/record_key.h"
#include "storage/records/stored_values.h"

namespace psfm {

/// A scene version as it lies in the store.
struct SceneRecord {
    StoredSceneVersion scene;
    /// Beside each placement: its solution's points are kept for good (FORMAT.md section 6).
    std::vector<bool> points_kept;
};

/// Payload of a scene version (FORMAT.md section 4).
/// @errors kInvalidArgument: placements or members not ascending, a similarity that is none
Result<std::string> encode_scene(const SceneRecord& record);

/// @errors kDamaged
Result<SceneRecord> decode_scene(const SceneKey& key, std::string_view payload);

}  // namespace psfm
