// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "graph/result.h"
#include "stages/algorithms/adjustment/adjustment_options.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// Standard deviation of an observation, relative to that of the smallest features: a blob's centre
/// is found to a fraction of its size.
double observation_sigma(const Keypoint& keypoint, const AdjustmentOptions& options);

/// What may move. Poses of other images that see the points stay as they are.
struct AdjustmentScope {
    std::vector<std::uint32_t> free_images;  ///< ascending local indices
    std::vector<CameraId> free_cameras;      ///< ascending; focal lengths and distortion
    std::vector<CameraId>
        free_principal_points;  ///< ascending, of free_cameras: the principal point as well
    std::vector<CameraId> held_focal_lengths;  ///< ascending, of free_cameras: only the rest moves
    /// Points seen by these images move; all other points that free images see stay fixed.
    std::vector<std::uint32_t> point_images;
    /// Points that more images see than this stay fixed: they are known well, and all who see them
    /// would take part on their account. 0: all move.
    std::size_t longest_moving_track = 0;
    /// Only these points take part at all, ascending; none given: all.
    std::optional<std::vector<std::uint32_t>> points;
    /// Fixes the gauge where no fixed image does: `origin` does not move at all, and `farthest`
    /// keeps the coordinate of its translation that tells its distance from the origin best, and so
    /// the scale.
    struct Gauge {
        std::uint32_t origin = 0;
        std::uint32_t farthest = 0;
    };
    std::optional<Gauge> gauge;
};

/// Cameras that at least so many registered images share, ascending; given ones keep their
/// principal point, and so do those of turned photographs, which only share the lens.
std::vector<CameraId> cameras_with_images(const WorkingModel& model, std::uint32_t images);

/// Everything free; the gauge is fixed at the image with most observations and the one farthest
/// from it.
AdjustmentScope full_scope(const WorkingModel& model, bool free_intrinsics);

/// Poses and points of some images; those of others hold the gauge. A camera is free when all its
/// images are. REQUIRES: two registered images beside them at least
AdjustmentScope region_scope(const WorkingModel& model, std::span<const std::uint32_t> images,
                             bool free_intrinsics);

/// Some images and the `neighbors` others that share most points with them; points of the former
/// move, but for those of long tracks (COLMAP 3.8's mapper does likewise). A camera is free when
/// all its images are.
/// @param longest_moving_track  as in AdjustmentScope
AdjustmentScope local_scope(const WorkingModel& model, std::span<const std::uint32_t> images,
                            std::size_t neighbors, std::size_t longest_moving_track,
                            bool free_intrinsics);

struct AdjustmentReport {
    std::size_t residuals = 0;
    int iterations = 0;
    double rms_before_px = 0.0;
    double rms_after_px = 0.0;
};

/// Bundle adjustment, on the reduced camera system with TBB or, for very many images, with Ceres on
/// one thread: bitwise repeatable for equal models, on any number of threads (Ceres's parameter
/// blocks all lie in one array, see docs/parts.md). Cameras whose intrinsics would end where they
/// make no sense (over flat land nothing holds a focal length) keep those that they had, and the
/// rest is adjusted with them.
/// @param cancel  when it becomes true the adjustment ends after the step under way, and the model
/// stays as it was; Ceres goes on to its end. May be null
/// @errors kDegenerate (nothing to adjust, or the solver found no usable step), kCancelled
Result<AdjustmentReport> adjust(WorkingModel& model, const AdjustmentScope& scope,
                                const AdjustmentOptions& options,
                                const std::atomic<bool>* cancel = nullptr);

}  // namespace psfm
