// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "stages/reconstruction/adjust/bundle_adjustment.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// Parameters of one adjustment in one array: cameras first, then poses, then points; blocks as in
/// reprojection.h.
struct AdjustmentParameters {
    std::vector<double> values;
    std::map<CameraId, std::size_t> camera_at;
    /// Cameras that take part in the block of another one, whose lens they have.
    std::map<CameraId, CameraId> owner_of_block;
    std::vector<std::size_t> pose_at;   ///< per image; kAbsent when it takes no part
    std::vector<std::size_t> point_at;  ///< per point; kAbsent when it takes no part
    static constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);  // Format: has no place

    CameraId owner_of(CameraId camera) const {
        const auto other = owner_of_block.find(camera);
        return other == owner_of_block.end() ? camera : other->second;
    }
};

struct AdjustmentResidual {
    WorkingModel::Feature feature;
    std::uint32_t point = 0;
};

/// What takes part. Residuals of a free point follow one another, ascending by image, and come
/// before those of points that stay.
struct AdjustmentSelection {
    std::vector<AdjustmentResidual> residuals;
    std::vector<bool> point_is_free;
    std::vector<bool> image_is_free;  ///< the origin of the gauge among them
};

AdjustmentSelection select_residuals(const WorkingModel& model, const AdjustmentScope& scope);

AdjustmentParameters lay_out(const WorkingModel& model,
                             const std::vector<AdjustmentResidual>& residuals);

/// What an observation's pixel is moved by, so that it has the principal point of its camera's
/// block.
Eigen::Vector2d shift_to_block(const WorkingModel& model, const AdjustmentParameters& parameters,
                               CameraId camera);

/// Whether a camera's block is free: every camera that takes part in it is.
bool block_is_free(const AdjustmentParameters& parameters, const AdjustmentScope& scope,
                   CameraId owner);

/// The coordinate of the farthest image's translation that changes most when the scene is scaled
/// about the origin: 0 x, 1 y, 2 z.
int scale_coordinate(const WorkingModel& model, const AdjustmentScope::Gauge& gauge);

/// Slots of a free camera's intrinsics that stay, ascending: unused ones, the principal point
/// unless it is free, focal lengths that are held.
std::vector<int> held_intrinsics(const WorkingModel& model, const AdjustmentScope& scope,
                                 CameraId camera);

/// Free cameras whose intrinsics make no sense now (validate), or whose focal length has left the
/// range of photographs', and those that share them, ascending.
std::vector<CameraId> senseless_cameras(const AdjustmentParameters& parameters,
                                        const AdjustmentScope& scope, const WorkingModel& model);

/// Takes the free ones of the parameters over.
void write_back(const AdjustmentParameters& parameters, const AdjustmentSelection& selection,
                const AdjustmentScope& scope, WorkingModel& model);

}  // namespace psfm
