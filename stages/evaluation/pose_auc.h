// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "stages/evaluation/named_pose.h"

namespace psfm {

/// Accuracy of relative poses, independent of any alignment: for every pair of reference images the
/// error is the larger of the angle between the two relative rotations and the angle between the
/// two directions of relative translation (the sign counts, since a model has one). A pair with an
/// image that the model lacks has failed. The area under the recall curve up to a limit, divided by
/// the limit, is then the mean over all pairs of max(0, 1 - error / limit). Source: Image Matching
/// Challenge (Jin et al., Image Matching across Wide Baselines, IJCV 2021, sec. 5), with the exact
/// step curve in place of bins. Where two reference cameras have one centre, the rotation alone
/// counts; where only the model's coincide, the pair has failed.
/// @param limits_deg  > 0
/// @return one area in [0, 1] a limit; zeros when the reference has no pair
/// Deterministic, and independent of the lists' order. Thread-safe.
std::vector<double> relative_pose_auc(std::span<const NamedPose> reference,
                                      std::span<const NamedPose> model,
                                      std::span<const double> limits_deg);

}  // namespace psfm
