// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "graph/reconstruction.h"
#include "graph/sim3.h"
#include "stages/algorithms/alignment/cluster_constraint.h"
#include "stages/merge/values/merge_options.h"
#include "stages/merge/values/model_cameras.h"

namespace psfm {

/// A model and what is known of its cameras. Neither null.
struct LookedAtModel {
    const Reconstruction* model = nullptr;
    const ModelCameras* cameras = nullptr;
};

/// Whether two models contradict each other where they stand, and how far that holds.
struct CompanionVerdict {
    bool contradict = false;
    /// Cameras of either that are matched with one beside them, wherever that holds.
    std::size_t matched = 0;
    /// The verdict is the same wherever no camera of `a` moves by more than `shift` [units of b],
    /// nor turns by more than `turn` [rad]. 0: nowhere else is known to.
    double shift = 0.0;
    double turn = 0.0;
};

/// Cameras of either model that stand beside some of the other, looking the same way, and share
/// nothing with any of them: they contradict each other where these are many
/// (ClusterConstraintOptions::min_unmatched_cameras, max_unmatched_part).
/// @param matched  edges of the view graph between the models, ascending. Weak ones count: where
///                 photographs have many better ones, as in streams of video, most are weak
/// Thread-safe. Cost: one search in the larger model for every camera of the smaller one that is
/// near.
CompanionVerdict judge_companions(const LookedAtModel& a, const LookedAtModel& b,
                                  const Sim3& b_from_a, std::span<const ImagePair> matched,
                                  const ClusterConstraintOptions& options);

/// Whether a verdict of `b_from_a_then` still holds. Never, unless the models are the same.
bool still_holds(const CompanionVerdict& verdict, const ModelCameras& a, const Sim3& b_from_a_then,
                 const Sim3& b_from_a, const ClusterConstraintOptions& options);

}  // namespace psfm
