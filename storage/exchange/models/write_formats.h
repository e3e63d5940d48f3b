// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to storage/exchange: one writer a format. Each stages the files of one model; `place` is
// the file or folder of the model without ending. Errors of all: kInvalidArgument (a name that the
// format cannot hold, with the format that can), kNoSpace, kIo.

#include <filesystem>

#include "storage/exchange/files/staged_files.h"
#include "storage/exchange/models/exported_model.h"
#include "storage/exchange/models/write_models.h"

namespace psfm {

/// cameras.bin, images.bin and points3D.bin of COLMAP 3.8 (src/base/reconstruction.cc).
Result<void> stage_colmap_binary(const ExportedModel& model, const std::filesystem::path& place,
                                 StagedFiles& files);

/// cameras.txt, images.txt and points3D.txt of COLMAP 3.8. Names with spaces are refused: COLMAP
/// would read their first word.
Result<void> stage_colmap_text(const ExportedModel& model, const std::filesystem::path& place,
                               StagedFiles& files);

/// PLACE.ply, binary little-endian: vertices with x y z (float) and red green blue; after the
/// points the camera centres, in pure green. Coordinates are less float_origin(model), which a
/// comment `origin X Y Z` tells where it is not zero.
Result<void> stage_ply(const ExportedModel& model, const std::filesystem::path& place,
                       PlyContents contents, StagedFiles& files);

/// PLACE.nvm (VisualSFM's NVM_V3): one focal length, one radial parameter. Measurements are
/// relative to the principal point. NVM distorts the other way round, so its parameter is -k1,
/// exact to first order as in COLMAP's export; further distortion and the difference of fx and fy
/// are lost.
Result<void> stage_nvm(const ExportedModel& model, const std::filesystem::path& place,
                       StagedFiles& files);

/// PLACE/bundle.out (Bundler v0.3) and PLACE/list.txt. Cameras look down their negative z axis,
/// image y points up. Tangential distortion and the difference of fx and fy are lost.
Result<void> stage_bundler(const ExportedModel& model, const std::filesystem::path& place,
                           StagedFiles& files);

/// PLACE/transforms.json (nerfstudio, instant-ngp) and PLACE/sparse_pc.ply. Poses are
/// world_from_camera with OpenGL's camera axes; the world is left as it is.
/// @param image_folder  that the images' names are in, as PLACE sees it
/// @param mask_folder  likewise of masks (mask_name()); empty: there are none
Result<void> stage_nerfstudio(const ExportedModel& model, const std::filesystem::path& place,
                              const std::filesystem::path& image_folder,
                              const std::filesystem::path& mask_folder, PlyContents points,
                              StagedFiles& files);

/// PLACE.gltf and PLACE.bin (glTF 2.0): the points as a mesh of POINTS, every image as a node with
/// a perspective camera, all below a node `world` that turns up to +y, glTF's own. Coordinates are
/// less float_origin(model), which the node's extras tell. Lens distortion and the offset of the
/// principal point have no place in glTF.
/// @param up  in the model's frame, unit length
Result<void> stage_gltf(const ExportedModel& model, const std::filesystem::path& place,
                        const Eigen::Vector3d& up, StagedFiles& files);

}  // namespace psfm
