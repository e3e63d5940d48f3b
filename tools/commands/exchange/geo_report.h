// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graph/image.h"
#include "stages/merge/geo/world_reference.h"
#include "storage/exchange/models/exported_model.h"

namespace psfm {

/// Where on the earth models stand; empty when the session does not tell.
/// @param images  of the session, ascending by id
std::optional<WorldReference> world_reference_of(std::span<const ExportedModel> models,
                                                 std::span<const Image> images);

/// "geo-referenced about LAT, LON: …", without a line end.
std::string describe(const WorldReference& reference);

/// Contents of an export's geo.txt: lines of a name and a value, comments after '#'.
std::string geo_text(const WorldReference& reference);

}  // namespace psfm
