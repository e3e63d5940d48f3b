// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graph/reconstruction.h"
#include "graph/result.h"

namespace psfm {

// A solution is stored whole, or as the changes to an earlier one of its cluster, "since" whose
// revision it is as it is.

/// Poses and cameras as stored.
struct SolutionPoses {
    /// Without points. Of changes: the images and cameras that are new or differ.
    Reconstruction model;
    std::uint32_t since = 0;  ///< 0: whole
};

/// Payload of a solution's poses and cameras (FORMAT.md section 4); points are not looked at.
/// @errors kInvalidArgument (breaks an invariant of Reconstruction)
Result<std::string> encode_poses(const Reconstruction& model);

/// The same as changes. @param before  of revision `since`; REQUIRES: the model has all its images
Result<std::string> encode_changed_poses(const Reconstruction& model, const Reconstruction& before,
                                         std::uint32_t since);

/// @errors kDamaged
Result<SolutionPoses> decode_poses(std::string_view payload);

/// @param poses  of the solution that `changes` are to; becomes what they make of it
/// @errors kDamaged: together they are no model
Result<void> apply(SolutionPoses changes, Reconstruction& poses);

/// What is stored of a solution beside its poses.
struct SolutionPoints {
    ScenePoints points;  ///< of changes: those after the ones that are kept
    std::string state_json;
    std::uint32_t since = 0;  ///< 0: whole
    /// Of changes: so many points kept, so many not, so many kept, …
    std::vector<std::uint32_t> kept = {};
};

/// Payload of a solution's points (FORMAT.md section 4).
/// @errors kInvalidArgument (breaks an invariant of Reconstruction, or above 2 GiB)
Result<std::string> encode_points(const Reconstruction& model, const std::string& state_json);

/// The same as changes. Points that are kept are not looked at again, and not compared.
/// @param succession  from the solution of revision `since`; REQUIRES: it is the model's
Result<std::string> encode_changed_points(const Reconstruction& model,
                                          const std::string& state_json,
                                          const Succession& succession, std::uint32_t since);

/// @errors kDamaged
Result<SolutionPoints> decode_points(std::string_view payload);

/// @param points  of the solution that `changes` are to; become what they make of them
/// @errors kDamaged: more are kept than there are
Result<void> apply(const SolutionPoints& changes, ScenePoints& points);

/// Whether every point observes registered images only.
bool points_belong_to(const ScenePoints& points, const Reconstruction& poses);

/// Whether a feature belongs to at most one point.
bool each_feature_in_one_point(const ScenePoints& points);

}  // namespace psfm
