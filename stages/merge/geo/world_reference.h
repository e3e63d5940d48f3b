// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "graph/ids.h"
#include "graph/image.h"
#include "stages/merge/geo/georeference.h"
#include "stages/merge/values/image_evidence.h"

namespace psfm {

/// Where a camera stands in a published version.
struct CameraCentre {
    ImageId image{};
    Eigen::Vector3d in_world;
};

/// That a version's world is the east-north-up frame about `datum` [m].
struct WorldReference {
    GpsPosition datum;                      ///< altitude 0 where the photograph has none
    std::vector<PositionAgreement> models;  ///< by model, also of those with too little evidence
};

/// Whether a published version is geo-referenced. Nothing of this is stored: a version is if the
/// cameras of one of its models stand where their photographs' positions say, with as much evidence
/// as it took to place it (place_components.h); otherwise its gauge is arbitrary.
/// @param models    the cameras of each effective cluster
/// @param evidence  of the session, ascending by image
/// Deterministic. Thread-safe.
std::optional<WorldReference> world_reference(std::span<const std::vector<CameraCentre>> models,
                                              std::span<const ImageEvidence> evidence,
                                              const GeoreferenceOptions& options = {});

}  // namespace psfm
