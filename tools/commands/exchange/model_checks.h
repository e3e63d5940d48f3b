// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "graph/result.h"
#include "storage/exchange/models/exported_model.h"

namespace psfm {

// What import looks at of a model before it makes anything of it.

/// A model of poses alone has an empty file of points; without one it is not whole.
/// @errors kNotFound
Result<void> check_points_are_there(const std::filesystem::path& folder);

/// Whether points lie before the cameras that observe them, and where their features are. Poses
/// that are written the other way round, and cameras of other images, show themselves so.
/// @param folder  of the model, for messages
/// @errors kInvalidArgument
Result<void> check_geometry(const ExportedModel& model, const std::filesystem::path& folder);

/// On stderr. They are not taken over.
void tell_of_spare_cameras(const ExportedModel& model);

}  // namespace psfm
