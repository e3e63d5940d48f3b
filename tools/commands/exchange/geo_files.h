// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graph/image.h"
#include "stages/merge/geo/world_reference.h"
#include "storage/exchange/models/exported_model.h"

namespace psfm {

/// An exported connected part.
struct GeoPart {
    std::size_t number = 0;  ///< in the export's names, and in the reference
    const ExportedModel* model = nullptr;
    /// What was subtracted from its coordinates in the files, so that 32-bit floats can hold them.
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
};

/// The files beside models that tell where on the earth these stand, by name (docs/exports.md):
///   geo.txt            the datum and each part's agreement, as lines of names and values
///   georeference.json  datum, world to earth-centred coordinates (4x4), accuracy and origin
///                      of each part, position and residual of each image
///   shots.geojson      a point for each placed photograph, with ODM's properties
/// Empty without a reference.
std::map<std::string, std::string> geo_files(const std::optional<WorldReference>& reference,
                                             std::span<const GeoPart> parts,
                                             std::span<const Image> images);

/// Whether an export of a session says so: as asked; else unless users have sent photographs to it
/// (`psfm serve`), since where they were is theirs to tell.
bool tells_location(const std::filesystem::path& session, std::optional<bool> asked);
/// How one has it said where it is not and nobody asked, without a line end; empty without a
/// reference.
std::string location_hint(const std::optional<WorldReference>& reference,
                          std::optional<bool> asked);

/// What is wrong with positions, in words without a line end: that the models do not agree with
/// them, or which are far from where their photographs stand. Empty: nothing, or there are none.
std::string position_trouble(const std::optional<WorldReference>& reference,
                             std::span<const ExportedModel> models, std::span<const Image> images);

/// Where up is in a model's frame: +z where it is geo-referenced, else as its photographs were held
/// (gravity.h). Unit length.
Eigen::Vector3d up_in_model(const ExportedModel& model, std::span<const Image> images,
                            bool georeferenced);

}  // namespace psfm
