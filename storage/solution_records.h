// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graph/reconstruction.h"
#include "graph/result.h"

namespace psfm {

/// Payload of a solution's poses and cameras (FORMAT.md section 4); points are not looked at.
/// @errors kInvalidArgument (breaks an invariant of Reconstruction)
Result<std::string> encode_poses(const Reconstruction& model);

/// A model without points. @errors kDamaged
Result<Reconstruction> decode_poses(std::string_view payload);

/// What is stored of a solution beside its poses.
struct SolutionPoints {
    std::vector<ScenePoint> points;
    std::string state_json;
};

/// Payload of a solution's points (FORMAT.md section 4).
/// @errors kInvalidArgument (breaks an invariant of Reconstruction, or above 2 GiB)
Result<std::string> encode_points(const Reconstruction& model, const std::string& state_json);

/// @errors kDamaged
Result<SolutionPoints> decode_points(std::string_view payload);

/// Whether every point observes registered images only.
bool points_belong_to(const std::vector<ScenePoint>& points, const Reconstruction& poses);

/// Whether a feature belongs to at most one point.
bool each_feature_in_one_point(const std::vector<ScenePoint>& points);

}  // namespace psfm
