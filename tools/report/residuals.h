// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/reconstruction.h"
#include "graph/result.h"
#include "storage/exchange/models/export_models.h"

namespace psfm {

/// How far a feature lies from where the model would have it.
struct Residual {
    std::uint32_t feature = 0;
    std::uint32_t point = 0;        ///< of the model
    Eigen::Vector2d observed_px;    ///< origin at the top-left corner of the top-left pixel
    Eigen::Vector2d difference_px;  ///< observed minus projected
};

/// The residuals of each image of a model, in the order of its images; by point. Observations that
/// lie behind the camera are left out.
/// @param wanted  by image of the model: 0 where none are asked for; empty: all of them
/// @errors kDamaged (a point observes a feature that its image lacks), those of the provider
Result<std::vector<std::vector<Residual>>> residuals_of(const Reconstruction& model,
                                                        const KeypointsProvider& keypoints,
                                                        std::span<const std::uint8_t> wanted = {});

/// Mean length [px]; 0 of none.
double mean_length_px(const std::vector<Residual>& residuals);

}  // namespace psfm
