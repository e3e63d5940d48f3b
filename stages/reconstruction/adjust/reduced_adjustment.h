// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "stages/algorithms/adjustment/tiled_matrix.h"
#include "stages/reconstruction/adjust/adjustment_problem.h"

namespace psfm {

/// Where the free cameras stand in the reduced camera system: poses first, in the order of their
/// elimination, then intrinsics.
struct AdjustmentColumns {
    static constexpr std::size_t kHeld = static_cast<std::size_t>(-1);  // Format: has no column
    struct Intrinsics {
        std::size_t column = 0;
        std::vector<int> slots;  ///< free ones, ascending; one column each
        bool free_principal_point = false;
    };
    /// Of a camera's block; null when it stays.
    const Intrinsics* of(const WorkingModel& model, CameraId camera) const {
        auto found = intrinsics.find(camera);
        if (found == intrinsics.end()) found = intrinsics.find(model.lens_of(camera));
        return found == intrinsics.end() ? nullptr : &found->second;
    }
    std::vector<std::size_t> pose;  ///< per image: first of six columns; kHeld when it stays
    std::map<CameraId, Intrinsics> intrinsics;  ///< free cameras that take part
    std::optional<std::size_t>
        held_translation;  ///< one column of a pose that stays, for the scale
    std::size_t count = 0;
};

AdjustmentColumns make_columns(const WorkingModel& model, const AdjustmentScope& scope,
                               const AdjustmentSelection& selection,
                               const AdjustmentParameters& parameters);

/// Residuals of each point become ascending by column, as adjust_reduced reads them.
void order_by_column(AdjustmentSelection& selection, const AdjustmentColumns& columns);

/// Which parts of the reduced camera system are not empty, once it is factorised.
TilePattern pattern_of(const AdjustmentColumns& columns, const AdjustmentSelection& selection,
                       const WorkingModel& model);

/// Half the sums of the losses, as Ceres counts them.
struct AdjustmentCosts {
    double before = 0.0;
    double after = 0.0;
    int iterations = 0;
};

/// Levenberg-Marquardt steps on the reduced camera system (Triggs et al., Bundle Adjustment - A
/// Modern Synthesis, 2000, sec. 6.1), with the residuals, the loss and the step control of Ceres's
/// solver. Points are eliminated one after the other and their derivatives forgotten, so that
/// memory is that of the system's tiles, and a few bytes an observation. Uses TBB's threads where
/// they are free; the result does not depend on them.
/// @param selection  ordered by column
/// @param pattern  of these columns
/// @param parameters  taken to the least cost that is found
/// @param cancel  asked before each step; may be null
/// @errors kDegenerate (no step lowers the cost, or a point is behind a camera at the start),
/// kCancelled
Result<AdjustmentCosts> adjust_reduced(const WorkingModel& model,
                                       const AdjustmentSelection& selection,
                                       const AdjustmentColumns& columns, const TilePattern& pattern,
                                       const AdjustmentOptions& options,
                                       AdjustmentParameters& parameters,
                                       const std::atomic<bool>* cancel);

}  // namespace psfm
