// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to storage/exchange: the readers of COLMAP's single files.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "graph/result.h"
#include "storage/exchange/models/exported_model.h"

namespace psfm::colmap {

Result<std::vector<ExportedCamera>> read_cameras_binary(const std::filesystem::path& path);
Result<std::vector<ExportedImage>> read_images_binary(const std::filesystem::path& path,
                                                      bool keep_keypoints);
Result<std::vector<ExportedPoint>> read_points_binary(const std::filesystem::path& path);

Result<std::vector<ExportedCamera>> read_cameras_text(const std::filesystem::path& path);
Result<std::vector<ExportedImage>> read_images_text(const std::filesystem::path& path,
                                                    bool keep_keypoints);
Result<std::vector<ExportedPoint>> read_points_text(const std::filesystem::path& path);

/// What is wrong with a value, in words; nothing when it is fine. The pose's quaternion is brought
/// to unit norm, unless it has it already (so that reading is exact).
std::optional<std::string> problem_of(const Camera& camera);
std::optional<std::string> problem_of_pose(Rigid3& cam_from_world);
std::optional<std::string> problem_of(const ExportedPoint& point);
std::optional<std::string> problem_of(const ExportedKeypoint& keypoint);

/// The error for a camera model that COLMAP has and psfm has not.
Error unsupported_model(const std::filesystem::path& path, std::uint32_t camera_id,
                        const std::string& model);

}  // namespace psfm::colmap
