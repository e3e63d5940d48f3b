// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "storage/exchange/files/staged_files.h"
#include "storage/exchange/models/exported_model.h"

namespace psfm {

/// The files of a data set's model, in its folder.
std::vector<std::filesystem::path> dataset_model_files(const std::filesystem::path& place);
/// The folders beside them that are made for other programs to write into.
std::vector<std::filesystem::path> dataset_folders(const std::filesystem::path& place);

/// A model of pictures (dataset_model) as every reader wants it, in PLACE:
///   sparse/0/{cameras,images,points3D}.bin   COLMAP's; linked as sparse/*.bin for COLMAP's and
///                                            openMVS' multi-view stereo
///   sparse/0/points3D.ply, sparse_pc.ply     the points, with normals of zero, as 3DGS and
///                                            nerfstudio read them
///   transforms.json                          nerfstudio's, pictures (and masks) by relative path
///   stereo/{patch-match,fusion}.cfg          and the folders that COLMAP's stereo writes into
/// @errors kInvalidArgument: a name that is no UTF-8; kNoSpace, kIo, with the path
/// @param masks  masks/ has one of each picture
Result<void> stage_dataset(const ExportedModel& model, const std::filesystem::path& place,
                           bool masks, StagedFiles& files);

}  // namespace psfm
