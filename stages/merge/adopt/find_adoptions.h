// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "graph/camera.h"
#include "graph/ids.h"
#include "graph/image.h"
#include "graph/two_view_geometry.h"
#include "stages/merge/run_merge.h"
#include "stages/reconstruction/model/solve_options.h"

namespace psfm {

/// An image that the cluster which tried it could not place.
struct UnplacedImage {
    ImageId id{};
    ClusterId tried_by{};
    CameraId camera_id{};
    Camera camera;  ///< as accepted; a model that has it knows better
    bool fix_intrinsics = false;
    std::uint64_t content_hash = 0;  ///< seeds RANSAC
    std::shared_ptr<const Keypoints> keypoints;
    /// An edge of the view graph to an image with a place.
    struct Edge {
        VerifiedPairPtr pair;
        ClusterId cluster{};  ///< that places the other image
    };
    std::vector<Edge> edges;
};

/// An image that has its place in the merged model.
struct Adoption {
    ImageId image{};
    ClusterId host{};                   ///< whose points it sees most of
    std::uint32_t inliers = 0;          ///< of its pose in the merged model
    std::uint32_t inliers_of_host = 0;  ///< points of the host among them
};

/// Between two clusters of an effective cluster. Exactly the identity for a cluster and itself, so
/// that what is seen of one cluster alone does not depend on where the merge puts it.
Sim3 frame_from_cluster(const ClusterPlacement& frame, const ClusterPlacement& cluster);

/// Tries images against the merged model (ours; the paper leaves them out): P3P on the points of
/// all clusters of an effective cluster, in one frame. An image is adopted by the cluster that
/// holds most of the points it agrees with, which then adds it as its own; the edges to placed
/// images, whose rotations its pose reproduces, must outweigh those that it contradicts (ours: a
/// look-alike part of the scene may hold more points than the right one). Not adopted: where the
/// host is the cluster that tried, or holds too few of the points alone.
/// @param merged  result of run_merge(problem)
/// @return ascending by image
/// Deterministic: bitwise equal for equal inputs. Thread-safe.
std::vector<Adoption> find_adoptions(const MergeProblem& problem, const MergeResult& merged,
                                     std::span<const UnplacedImage> unplaced,
                                     const SolveOptions& options);

}  // namespace psfm
