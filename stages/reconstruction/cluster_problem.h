// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "graph/camera.h"
#include "graph/ids.h"
#include "graph/image.h"
#include "graph/reconstruction.h"
#include "graph/scene.h"
#include "graph/two_view_geometry.h"

namespace psfm {

/// One member of a cluster.
struct ClusterImage {
    ImageId id{};
    CameraId camera{};
    std::uint64_t content_hash = 0;  ///< seeds whatever is random about this image
    std::shared_ptr<const Keypoints> keypoints;
};

/// What a solution hands to the next solve of the same cluster, beside its model.
struct SolveState {
    /// Images that were in the model when all of it was last adjusted: decides when it has grown by
    /// eta_grow.
    std::uint32_t images_at_full_adjustment = 0;
    bool operator==(const SolveState&) const = default;
};

/// Everything that solving one cluster needs, and nothing else: equal problems have equal
/// solutions.
struct ClusterProblem {
    ClusterId cluster{};
    std::uint32_t topology = 0;        ///< the cluster's topology count that this problem describes
    std::vector<ClusterImage> images;  ///< members, ascending by id
    std::map<CameraId, Camera> cameras;  ///< as accepted; every camera of `images`
    std::vector<VerifiedPairPtr> pairs;  ///< edges with both ends in the cluster, ascending
    /// The model to extend: all its images are members. Null: solve anew.
    std::shared_ptr<const Reconstruction> recycled;
    SolveState recycled_state;
    bool fix_intrinsics = false;
    bool settle = false;  ///< no image is to be added: adjust all of the model to convergence
    std::uint64_t seed = 0;
};

/// How a solution came about (paper, fig. "reconstruction").
enum class SolveKind : std::uint8_t { kTooSmall, kNew, kExtend, kSettle };
const char* name_of(SolveKind kind);

struct SolveStatistics {
    SolveKind kind = SolveKind::kNew;
    std::uint32_t registered = 0;     ///< images added by this solve
    std::uint32_t removed_edges = 0;  ///< edges dropped from the local graph by rotation averaging
    std::uint32_t full_adjustments = 0;
    std::uint32_t local_adjustments = 0;
    double mean_error_px = 0.0;
    double milliseconds = 0.0;
};

struct ClusterSolution {
    ClusterId cluster{};
    std::uint32_t topology = 0;
    std::shared_ptr<const Reconstruction>
        model;  ///< never null; empty when nothing could be solved
    SolveState state;
    std::vector<std::pair<ImageId, WaitReason>>
        waiting;  ///< members that are not in the model, ascending
    SolveStatistics statistics;
};

}  // namespace psfm
