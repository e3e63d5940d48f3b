// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/local_graph.h"

#include <algorithm>
#include <ranges>

#include "graph/camera_lens.h"
#include "stages/algorithms/averaging/average_rotations.h"
#include "stages/algorithms/focal/calibrate_focals.h"
#include "stages/algorithms/math/in_parallel.h"
#include "stages/reconstruction/model/local_numbers.h"
#include "stages/reconstruction/model/strong_lenses.h"
#include "stages/verification/with_rotation.h"

namespace psfm {
namespace {

/// The camera that a pair was verified with, at the focal length that is believed now.
Camera with_focal(Camera verified, const Camera& believed) {
    verified.params[0] = believed.fx();
    if (verified.has_two_focals()) verified.params[1] = believed.fy();
    verified.focal_source = FocalSource::kEstimated;
    return verified;
}

/// That of the one of which more is known: a model's, then a given one, then EXIF's.
void give_twins_one_lens(const ClusterProblem& problem, std::map<CameraId, Camera>& cameras) {
    for (const auto& [twin, camera] : problem.twins) {
        const auto first = cameras.find(camera);
        const auto second = cameras.find(twin);
        if (first == cameras.end() || second == cameras.end()) continue;
        const bool second_knows = second->second.focal_source > first->second.focal_source;
        Camera& taught = second_knows ? first->second : second->second;
        taught = with_lens_of(taught, second_knows ? second->second : first->second);
    }
}

/// Guard: models of fewer images hardly determine intrinsics; all pairs together tell more.
constexpr std::size_t kImagesToKnowCameras = 5;

/// Intrinsics from the recycled model where it has them; unknown focal lengths from fundamental
/// matrices.
Result<std::map<CameraId, Camera>> starting_cameras(const ClusterProblem& problem,
                                                    const LocalNumbers& numbers,
                                                    const SolveOptions& options) {
    std::map<CameraId, Camera> cameras = problem.cameras;
    for (const auto& [id, camera] : problem.calibrated) {
        if (cameras.contains(id)) cameras[id] = camera;
    }
    // The largest model comes first and has the last word.
    for (const auto& model : std::views::reverse(problem.recycled)) {
        if (model->images.size() < kImagesToKnowCameras) continue;
        for (const auto& [id, camera] : model->cameras) {
            if (cameras.contains(id)) cameras[id] = camera;
        }
    }
    give_twins_one_lens(problem, cameras);
    const bool all_known = std::ranges::all_of(
        cameras, [](const auto& c) { return c.second.focal_source != FocalSource::kUnknown; });
    if (all_known || problem.fix_intrinsics) return cameras;
    std::map<ImageId, CameraId> camera_of;
    for (const ClusterImage& image : problem.images) camera_of[image.id] = image.camera;
    // The pairs were verified without the distortion that the recycled model has found since.
    std::map<CameraId, Camera> as_verified = problem.cameras;
    for (auto& [id, camera] : as_verified) {
        if (camera.focal_source == FocalSource::kUnknown &&
            cameras.at(id).focal_source != FocalSource::kUnknown) {
            camera = with_focal(camera, cameras.at(id));
        }
    }
    const auto keypoints_of = [&](ImageId image) {
        return std::span<const Keypoint>(*problem.images[numbers.of(image)].keypoints);
    };
    const auto calibration = calibrate_focals(pairs_of(problem), as_verified, camera_of,
                                              options.focal_calibration, keypoints_of);
    if (!calibration.ok()) return calibration.error();
    for (const auto& [id, focal] : calibration->focals) {
        // The source stays kUnknown: registration still searches around the estimate.
        Camera& camera = cameras.at(id);
        camera.params[0] = focal.focal_px;
        if (camera.has_two_focals()) camera.params[1] = focal.focal_px;
    }
    give_twins_one_lens(problem, cameras);
    return cameras;
}

/// A pair's relative pose where it was verified without its focal lengths: it follows from the
/// cameras as they are believed now.
/// @return null when no pose agrees with the pair's matches any more
VerifiedPairPtr with_focals(const VerifiedPairPtr& pair, const ClusterImage& image1,
                            const ClusterImage& image2, const ClusterProblem& problem,
                            const LocalGraph& graph, const VerifyOptions& options) {
    const Camera& verified1 = problem.cameras.at(image1.camera);
    const Camera& verified2 = problem.cameras.at(image2.camera);
    if (verified1.focal_source != FocalSource::kUnknown &&
        verified2.focal_source != FocalSource::kUnknown)
        return pair;
    const MatchedViews views{*image1.keypoints,
                             *image2.keypoints,
                             with_focal(verified1, graph.cameras.at(image1.camera)),
                             with_focal(verified2, graph.cameras.at(image2.camera)),
                             {}};
    auto geometry = with_intrinsics(pair->geometry, views, options);
    if (!geometry.ok()) return nullptr;  // Expected: its matches do not hold with these cameras
    return std::make_shared<const VerifiedPair>(VerifiedPair{pair->pair, *std::move(geometry)});
}

/// The same, and where lenses have turned out to be strong, a pair that they may have bent is seen
/// through them.
VerifiedPairPtr with_cameras(const VerifiedPairPtr& pair, const ClusterProblem& problem,
                             const LocalNumbers& numbers, const LocalGraph& graph,
                             const StrongLenses& strong, const VerifyOptions& options) {
    const ClusterImage& image1 = problem.images[numbers.of(pair->pair.first)];
    const ClusterImage& image2 = problem.images[numbers.of(pair->pair.second)];
    VerifiedPairPtr local = with_focals(pair, image1, image2, problem, graph, options);
    if (strong.may_bend(local ? *local : *pair, image1, image2)) {
        if (auto seen = seen_through(pair, image1, image2, graph.cameras, options)) return seen;
    }
    return local;
}

/// Whether a pair's matches leave more than one pose to choose from: of planes, unknown focal
/// lengths, and few matches. What was measured well is wrong where it disagrees.
bool is_ambiguous(const VerifiedPair& verified, bool is_weak) {
    return is_weak || verified.geometry.kind == TwoViewKind::kPlanar ||
           verified.geometry.kind == TwoViewKind::kFundamental;
}

/// A pair that differs from the averaged rotations, seen as they say; null: it cannot be.
VerifiedPairPtr as_averaged(const VerifiedPairPtr& pair, const ClusterProblem& problem,
                            const LocalNumbers& numbers, const LocalGraph& graph,
                            const SolveOptions& options) {
    if (pair->geometry.kind == TwoViewKind::kPureRotation) return nullptr;
    const std::uint32_t i = numbers.of(pair->pair.first);
    const std::uint32_t j = numbers.of(pair->pair.second);
    const ClusterImage& image1 = problem.images[i];
    const ClusterImage& image2 = problem.images[j];
    const MatchedViews views{*image1.keypoints,
                             *image2.keypoints,
                             graph.cameras.at(image1.camera),
                             graph.cameras.at(image2.camera),
                             {}};
    auto geometry =
        with_rotation(pair->geometry, views, graph.rotations[j] * graph.rotations[i].conjugate(),
                      options.verification, {.max_angle_deg = options.max_edge_error_deg});
    if (!geometry.ok()) return nullptr;  // Expected: its matches do not hold with this rotation
    return std::make_shared<const VerifiedPair>(VerifiedPair{pair->pair, *std::move(geometry)});
}

/// How much an edge counts among others.
double weight_of(const TwoViewGeometry& geometry, const SolveOptions& options) {
    const double inliers = std::max(1.0, static_cast<double>(geometry.inliers.size()));
    return options.plausibility ? inliers * plausibility(geometry, *options.plausibility) : inliers;
}

/// What the cameras that are believed now leave of pairs; side by side.
struct SeenPairs {
    std::vector<VerifiedPairPtr> pairs;
    std::vector<bool> ambiguous;
    std::vector<RelativeRotation> rotations;
    std::size_t of_edges = 0;  ///< as many of them, the first ones, are edges; the others are weak
};

SeenPairs see_pairs(std::span<const VerifiedPairPtr> edges, std::span<const VerifiedPairPtr> weak,
                    const ClusterProblem& problem, const LocalGraph& graph,
                    const SolveOptions& options) {
    const LocalNumbers numbers(problem);
    const StrongLenses strong(problem, graph.cameras, options.strong_lenses);
    std::vector<VerifiedPairPtr> verified(edges.begin(), edges.end());
    verified.insert(verified.end(), weak.begin(), weak.end());
    std::vector<VerifiedPairPtr> local(verified.size());
    in_parallel(verified.size(), [&](std::size_t i) {
        local[i] = with_cameras(verified[i], problem, numbers, graph, strong, options.verification);
    });
    SeenPairs seen;
    for (std::size_t i = 0; i < verified.size(); ++i) {
        if (!local[i]) continue;
        const bool is_weak = i >= edges.size();
        const ImagePair ids = verified[i]->pair;
        const TwoViewGeometry& geometry = local[i]->geometry;
        const double factor = is_weak ? options.weak_edge_weight : 1.0;
        seen.rotations.push_back({numbers.of(ids.first), numbers.of(ids.second),
                                  geometry.cam2_from_cam1.rotation,
                                  factor * weight_of(geometry, options)});
        seen.ambiguous.push_back(is_ambiguous(*verified[i], is_weak));
        seen.pairs.push_back(std::move(local[i]));
        seen.of_edges += is_weak ? 0 : 1;
    }
    return seen;
}

}  // namespace

Result<LocalGraph> make_local_graph(const ClusterProblem& problem, const SolveOptions& options) {
    const LocalNumbers numbers(problem);
    LocalGraph graph;
    auto cameras = starting_cameras(problem, numbers, options);
    if (!cameras.ok()) return cameras.error();
    graph.cameras = *std::move(cameras);
    const std::vector<VerifiedPairPtr> of_cluster = pairs_of(problem);
    SeenPairs seen = see_pairs(of_cluster, weak_pairs_of(problem), problem, graph, options);
    const auto averaged =
        average_rotations(seen.rotations, static_cast<std::uint32_t>(problem.images.size()),
                          options.rotation_averaging);
    if (!averaged.ok()) return averaged.error();
    graph.rotations = averaged->node_from_reference;
    graph.component = averaged->component;
    std::size_t kept = 0;
    for (std::size_t edge = 0; edge < seen.pairs.size(); ++edge) {
        VerifiedPairPtr pair = seen.pairs[edge];
        if (averaged->residual_deg[edge] > options.max_edge_error_deg)
            pair = seen.ambiguous[edge] ? as_averaged(pair, problem, numbers, graph, options)
                                        : nullptr;
        if (!pair) continue;
        kept += edge < seen.of_edges ? 1 : 0;
        graph.pairs.push_back(std::move(pair));
    }
    std::ranges::sort(graph.pairs, {}, [](const VerifiedPairPtr& pair) { return pair->pair; });
    graph.removed_edges = static_cast<std::uint32_t>(of_cluster.size() - kept);
    return graph;
}

CorrespondenceGraph correspondences_of(const ClusterProblem& problem, const LocalGraph& graph) {
    std::vector<ImageId> ids;
    std::vector<std::uint32_t> feature_counts;
    for (const ClusterImage& image : problem.images) {
        ids.push_back(image.id);
        feature_counts.push_back(static_cast<std::uint32_t>(image.keypoints->size()));
    }
    return {ids, feature_counts, graph.pairs};
}

}  // namespace psfm
