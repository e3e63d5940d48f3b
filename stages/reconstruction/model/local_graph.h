// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <vector>

#include "graph/result.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/correspondence_graph.h"
#include "stages/reconstruction/model/solve_options.h"

namespace psfm {

/// The sub-graph that one solve works on: intrinsics to start from, and the pairs that agree with
/// the averaged rotations. The session's view graph is not touched: what is dropped here is looked
/// at again in the next solve (paper sec. "Progressive Viewgraph").
struct LocalGraph {
    std::map<CameraId, Camera>
        cameras;  ///< as accepted, recycled, or calibrated from fundamental matrices
    std::vector<VerifiedPairPtr> pairs;  ///< ascending; relative poses as with `cameras`
    std::uint32_t removed_edges = 0;
    /// Averaged rotations by local image (cam_from_cluster), comparable within one component only.
    std::vector<Eigen::Quaterniond> rotations;
    std::vector<std::uint32_t> component;  ///< by local image, of the pairs before any was dropped
};

/// Calibrates unknown focal lengths, averages rotations, drops outlier edges
/// (paper sec. "Robust Rotation Averaging"). Weak edges are taken in where they agree with the
/// rotations that the others say; between images that no others connect they decide.
/// @errors kInvalidArgument, kDegenerate
Result<LocalGraph> make_local_graph(const ClusterProblem& problem, const SolveOptions& options);

/// The matches of the pairs that are left.
CorrespondenceGraph correspondences_of(const ClusterProblem& problem, const LocalGraph& graph);

}  // namespace psfm
