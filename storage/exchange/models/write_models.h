// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graph/result.h"
#include "storage/exchange/models/export_models.h"
#include "storage/exchange/models/exported_model.h"

namespace psfm {

/// What a model can be written as. N below counts models (effective clusters, largest first) from
/// 0.
enum class ExportFormat {
    kColmap,      ///< "colmap": DIR/N/{cameras,images,points3D}.bin
    kColmapText,  ///< "colmap-text": DIR/N/{cameras,images,points3D}.txt
    kPly,         ///< "ply": DIR/N.ply, coloured points and camera centres
    kNvm,         ///< "nvm": DIR/N.nvm (VisualSFM)
    kBundler,     ///< "bundler": DIR/N/bundle.out and list.txt (Bundler v0.3)
    kNerfstudio,  ///< "nerfstudio": DIR/N/transforms.json (also instant-ngp) and sparse_pc.ply
    kGltf,        ///< "gltf": DIR/N.gltf and N.bin (glTF 2.0)
};

/// Names as on the command line, in the order of ExportFormat.
std::span<const std::string_view> export_format_names();
std::optional<ExportFormat> export_format_from_name(std::string_view name);

/// What a format makes of features: those without 2D observations need their colours only.
FeatureUse feature_use(ExportFormat format);

/// How a format's readers keep the coordinates of points.
enum class PointCoordinates {
    kDoubles,         ///< or text: all points as they are
    kFloats,          ///< as 32-bit floats: relative to float_origin (dataset_model.h)
    kDistinctFloats,  ///< and of points that have one place as floats the first (distinct_points.h)
};
PointCoordinates point_coordinates(ExportFormat format);

enum class PlyContents {
    kPoints,
    kPointsWithNormals,  ///< of zero: 3DGS's own trainer wants some
    kPointsAndCameras,
};

struct WriteModelsOptions {
    /// Where the photographs are, for formats that refer to them by path (nerfstudio: the model's
    /// folder gets a link `images` to it). Empty, or no folder: no link.
    std::filesystem::path photo_folder = {};
    /// What PLY files hold.
    PlyContents ply = PlyContents::kPointsAndCameras;
    /// Files of DIR that tell where on the earth the models stand, by name.
    std::map<std::string, std::string> geo_files = {};
    /// Where up is in each model's frame, for formats with an up of their own (glTF). Fewer than
    /// models: -y, as in a camera's frame.
    std::vector<Eigen::Vector3d> up = {};
};

/// Writes models into a folder, which is made if need be. All files appear together at the end, so
/// that a failure leaves no half-written file and an earlier export as it was. What psfm wrote
/// there before, in whatever format, is replaced or removed (PreviousExport). Files of anybody else
/// that would be taken for part of this export (further models, COLMAP's other encoding) stop it,
/// and nothing else in the folder is touched.
/// @return one path a model: its folder, or its file
/// @errors kInvalidArgument (a name that the format cannot hold, a file of somebody else in the
/// way),
///         kUnreadable (.psfm-export), kNoSpace, kIo; all with the path
Result<std::vector<std::filesystem::path>> write_models(std::span<const ExportedModel> models,
                                                        ExportFormat format,
                                                        const std::filesystem::path& folder,
                                                        const WriteModelsOptions& options = {});

}  // namespace psfm
