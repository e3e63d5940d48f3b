// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "graph/image.h"
#include "graph/scene.h"
#include "stages/merge/geo/world_reference.h"

namespace psfm {

/// Where on the earth a scene stands, by effective cluster; empty when the session does not tell.
/// @param images  of the session, ascending by id
std::optional<WorldReference> world_reference_of(const Scene& scene, std::span<const Image> images);

/// Whether parts stand where positions put them, all of them.
bool stands_on_the_earth(const std::optional<WorldReference>& reference);

}  // namespace psfm
