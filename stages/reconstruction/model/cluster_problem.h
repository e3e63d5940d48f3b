// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "graph/camera.h"
#include "graph/ids.h"
#include "graph/image.h"
#include "graph/reconstruction.h"
#include "graph/scene.h"
#include "graph/two_view_geometry.h"
#include "graph/view_graph.h"
#include "graph/weakness.h"

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
    /// Images that were in the model when it was last adjusted, all of it or where it had grown:
    /// decides when it has grown by eta_grow.
    std::uint32_t images_at_full_adjustment = 0;
    /// The last time that a model of this cluster contradicted the averaged rotations: how much the
    /// better of the old model and a new one did, and with how many images. Nothing is gained by
    /// solving new again before either has grown.
    double tolerated_contradiction_deg = 0.0;
    std::uint32_t images_at_contradiction = 0;
    /// Whether solving new was put off then until the model settles (is_put_off).
    bool new_start_is_due = false;
    /// Images of the cluster when it was last solved new, whichever model was kept.
    std::uint32_t images_at_start = 0;
    /// Images of the model when it was last asked for places (separate_places), and whether images
    /// that were added since have given reason to.
    std::uint32_t images_at_places = 0;
    bool has_strangers = false;
    /// Images of the cluster when a better model was looked for last (reconsider_model).
    std::uint32_t images_when_reconsidered = 0;
    /// Images of the model when it was last asked which cameras may be one (judge_ties).
    std::uint32_t images_at_ties = 0;
    Weaknesses weaknesses = {};  ///< of the model, when it was last assessed
    bool operator==(const SolveState&) const = default;
};

/// Everything that solving one cluster needs, and nothing else: equal problems have equal
/// solutions.
struct ClusterProblem {
    ClusterId cluster{};
    std::uint32_t topology = 0;        ///< the cluster's topology count that this problem describes
    std::vector<ClusterImage> images;  ///< members, ascending by id
    std::map<CameraId, Camera> cameras;  ///< as accepted; every camera of `images`
    /// Cameras of one image each that may well be one and the same, by the kind of their
    /// photographs: they are taken for one unless the data say otherwise (solve_with_ties.h).
    std::map<CameraId, std::uint32_t> alike;
    /// Cameras of turned photographs that have the lens of another camera: the same focal length
    /// and distortion, another principal point (camera_ties.h).
    std::map<CameraId, CameraId> twins;
    /// Some of them as other clusters have estimated them: better to start from than EXIF.
    std::map<CameraId, Camera> calibrated;
    /// Those of its edges count that have both ends in the cluster (pairs_of).
    ViewGraph view_graph;
    /// Models to start from, most images first; images that are no members are left out. None:
    /// solve new; one: extend it; several: join them, and extend the result (transfer).
    std::vector<std::shared_ptr<const Reconstruction>> recycled;
    SolveState recycled_state;  ///< of the first
    bool fix_intrinsics = false;
    /// Cameras that registered images share which are not in this problem: nothing here may refine
    /// them (surroundings.h).
    std::set<CameraId> held_cameras;
    /// No more images come: weak edges (ViewGraph::Edge) are looked at, too, since nothing better
    /// comes any more, and a doubtful model is compared with others (reconsider_model).
    bool concluding = false;
    bool settle = false;  ///< no image is to be added: adjust all of the model to convergence
    std::uint64_t seed = 0;
};

/// The edges with both ends in the cluster, without weak ones, ascending. Listing those of
/// thousands of images takes longer than adding one to them.
std::vector<VerifiedPairPtr> pairs_of(const ClusterProblem& problem);
/// The weak ones (ViewGraph::Edge), ascending; none where the problem does without.
std::vector<VerifiedPairPtr> weak_pairs_of(const ClusterProblem& problem);

/// The camera whose lens it has (twins); itself where it has one of its own.
CameraId lens_of(const ClusterProblem& problem, CameraId camera);

/// How a solution came about (paper, fig. "reconstruction").
enum class SolveKind : std::uint8_t { kTooSmall, kNew, kExtend, kTransfer, kSettle };
const char* name_of(SolveKind kind);

/// Where a model contradicts the averaged rotations most (paper: rho_l).
struct Contradiction {
    ImagePair pair;            ///< the worst edge
    double angle_deg = 0.0;    ///< between its averaged and its reconstructed relative rotation
    std::uint32_t edges = 0;   ///< edges with both images in the model
    std::uint32_t beyond = 0;  ///< those of them that contradict by more than rho_l,max
};

/// A recycled model was given up, or a part of it.
struct Reset {
    enum class Reason : std::uint8_t {
        kContradiction,  ///< paper sec. "Detection of Bad Configurations"
        kStuck,          ///< most images of the cluster could not be added to it
        kMissing,        ///< its images should see what they do not (reconsider_model)
    } reason = Reason::kContradiction;
    Contradiction contradiction;       ///< of the recycled model
    std::uint32_t placed_before = 0;   ///< images in it
    std::vector<ImageId> images = {};  ///< that were placed anew, ascending; none: all of them
};

struct SolveStatistics {
    SolveKind kind = SolveKind::kNew;
    bool is_global = false;           ///< new, and started with all images at once
    std::uint32_t joined_models = 0;  ///< recycled models that could be joined to the first
    std::uint32_t left_models = 0;    ///< and those that could not
    std::uint32_t closed_loops = 0;   ///< times that what was open in the model was closed
    std::optional<Reset> reset;
    bool ties_changed = false;        ///< cameras that were tied are not any more, or the contrary
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
    /// From the problem's first recycled model, when most of that stayed as it was.
    std::optional<Succession> succession;
    SolveState state;
    std::vector<std::pair<ImageId, WaitReason>>
        waiting;  ///< members that are not in the model, ascending
    /// Images of different places, which are not to be in one cluster: they stand side by side in
    /// the model and share nothing (separate_places), or the model leaves some out that make
    /// another one (places_of_left_out). Empty: the cluster is of one place.
    std::vector<std::vector<ImageId>> places;
    SolveStatistics statistics;
};

}  // namespace psfm
