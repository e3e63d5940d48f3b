// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "graph/result.h"
#include "scheduler/session/session_config.h"

namespace psfm {

/// Intrinsics by photograph name from a COLMAP model (`--cameras DIR`); its poses are not used.
/// Photographs of one COLMAP camera share it; so do those of cameras with equal size, model and
/// parameters.
/// @errors those of read_colmap_model; kInvalidArgument (intrinsics out of range)
Result<std::map<std::string, GivenCamera>> read_given_cameras(const std::filesystem::path& folder);

}  // namespace psfm
