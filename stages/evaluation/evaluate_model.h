// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "graph/result.h"
#include "graph/sim3.h"
#include "stages/evaluation/named_pose.h"
#include "stages/evaluation/robust_alignment.h"

namespace psfm {

struct EvaluationOptions {
    RobustAlignmentOptions alignment{};
    /// Where two reference cameras nearly coincide, the smallest distance is taken as at least this
    /// part of the median nearest-neighbour distance. Raised: coarser outliers; lowered: a
    /// reference with a near duplicate calls everything an outlier. Source: docs/datasets.md,
    /// definition of an outlier camera.
    double min_spacing_ratio = 0.25;
};
Result<void> validate(const EvaluationOptions& options);

/// Error of one image that model and reference share.
struct ImageError {
    std::string name;           ///< as in the reference
    double position = 0.0;      ///< distance of aligned and true centre, in the reference's units
    double rotation_deg = 0.0;  ///< angle between aligned and true orientation
    bool outlier = false;       ///< position above outlier_threshold
};

/// One model against a reference, after a robust similarity alignment of camera centres. Position
/// errors are in the reference's units; all statistics are over `images`, outliers included.
struct ModelEvaluation {
    std::size_t registered = 0;      ///< images of the model, in the reference or not
    std::vector<ImageError> images;  ///< those in the reference too, ascending by name
    double position_mean = 0.0;
    double position_median = 0.0;
    double position_rms = 0.0;
    double position_relative =
        0.0;  ///< RMS / diagonal of the bounding box of all reference centres
    double rotation_median_deg = 0.0;
    double rotation_max_deg = 0.0;
    std::size_t outliers = 0;
    double outlier_threshold = 0.0;  ///< [units of the reference]; also RANSAC's inlier threshold
    Sim3 reference_from_model;
    bool consensus =
        true;  ///< false: no three cameras agree with the reference within the threshold
};

/// Half the smallest distance between two cameras of the reference (see EvaluationOptions for its
/// floor): a camera off by more is an outlier.
/// @errors kTooFewMatches (fewer than two cameras), kDegenerate (more than half of them in one
/// place)
Result<double> outlier_threshold(std::span<const NamedPose> reference,
                                 const EvaluationOptions& options);

/// Compares a model with a reference by the definitions of docs/datasets.md. Where the centres
/// lie on one line, the turn about it, which they leave free, is the one that fits the orientations
/// best.
/// @errors kTooFewMatches (fewer than three common images), kDegenerate (the centres of one side
/// coincide) Deterministic for equal inputs and seed, and independent of the lists' order.
/// Thread-safe.
Result<ModelEvaluation> evaluate_model(std::span<const NamedPose> reference,
                                       std::span<const NamedPose> model,
                                       const EvaluationOptions& options = {});

/// Outlier cameras over all models of at least `min_cameras` images, each aligned by itself,
/// summed: what a session with several effective clusters has wrong at some moment. A model
/// collapsed into one point counts wholly; one with fewer than three images in the reference cannot
/// be judged and does not count.
/// @errors those of outlier_threshold
Result<std::size_t> summed_outliers(std::span<const NamedPose> reference,
                                    std::span<const std::vector<NamedPose>> models,
                                    std::size_t min_cameras = 5,
                                    const EvaluationOptions& options = {});

}  // namespace psfm
