// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <map>
#include <vector>

#include "graph/result.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/local_graph.h"
#include "stages/reconstruction/model/solve_options.h"

namespace psfm {

/// Focal length and distortion of cameras that several images share, from small models: images that
/// see much of each other from different sides are reconstructed incrementally. Averaged rotations
/// need this beforehand: what intrinsics are wrong by bends every relative rotation the same way,
/// and a model that starts bent does not straighten out in bundle adjustment (docs/accuracy.md).
/// @return those of the cameras with enough images that small models determined, and of their
/// twins; given intrinsics and those of earlier reconstructions are left alone
/// @errors kCancelled
/// Deterministic.
Result<std::map<CameraId, Camera>> calibrate_shared_cameras(const ClusterProblem& problem,
                                                            const LocalGraph& graph,
                                                            const SolveOptions& options,
                                                            const std::atomic<bool>* cancel);

/// The graph's pairs as the calibrated cameras see them; those whose pose no longer agrees with
/// their matches are left out.
std::vector<VerifiedPairPtr> pairs_seen_through(const std::map<CameraId, Camera>& calibrated,
                                                const ClusterProblem& problem,
                                                const LocalGraph& graph,
                                                const VerifyOptions& options);

}  // namespace psfm
