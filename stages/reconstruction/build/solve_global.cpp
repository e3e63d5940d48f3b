// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/solve_global.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stages/algorithms/averaging/average_positions.h"
#include "stages/algorithms/averaging/average_rotations.h"
#include "stages/algorithms/averaging/filter_directions.h"
#include "stages/reconstruction/adjust/bundle_adjustment.h"
#include "stages/reconstruction/build/calibrate_shared.h"
#include "stages/reconstruction/build/global_directions.h"
#include "stages/reconstruction/build/refine_model.h"
#include "stages/reconstruction/model/cancelled.h"
#include "stages/reconstruction/model/estimate_point.h"
#include "stages/reconstruction/model/tracks.h"

namespace psfm {
namespace {

/// Rotations of the largest component of the local graph.
struct ComponentRotations {
    std::vector<Eigen::Quaterniond> cam_from_cluster;  ///< by local image
    std::vector<VerifiedPairPtr> pairs;  ///< of the component, those that agree with the rotations
};

Result<ComponentRotations> refined_rotations(const WorkingModel& model,
                                             const std::vector<VerifiedPairPtr>& pairs,
                                             const SolveOptions& options) {
    std::map<ImageId, std::uint32_t> local;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        local[model.image_id(image)] = image;
    }
    std::vector<RelativeRotation> edges;
    for (const VerifiedPairPtr& pair : pairs) {
        const TwoViewGeometry& geometry = pair->geometry;
        edges.push_back({local.at(pair->pair.first), local.at(pair->pair.second),
                         geometry.cam2_from_cam1.rotation,
                         std::max(1.0, static_cast<double>(geometry.inliers.size()))});
    }
    RotationAveragingOptions averaging = options.rotation_averaging;
    averaging.refine_iterations = options.global.rotation_refinements;
    auto averaged =
        average_rotations(edges, static_cast<std::uint32_t>(model.image_count()), averaging);
    if (!averaged.ok()) return averaged.error();
    std::vector<std::uint32_t> size(averaged->component_count, 0);
    for (const std::uint32_t component : averaged->component) ++size[component];
    const auto largest = static_cast<std::uint32_t>(std::ranges::max_element(size) - size.begin());
    ComponentRotations rotations;
    for (const std::uint32_t edge : edges_within(*averaged, options.max_edge_error_deg)) {
        if (averaged->component[edges[edge].i] == largest) rotations.pairs.push_back(pairs[edge]);
    }
    rotations.cam_from_cluster = std::move(averaged->node_from_reference);
    return rotations;
}

/// Depends on which images take part, not on their numbers.
std::uint64_t seed_of(const ClusterProblem& problem) {
    std::uint64_t seed = problem.seed;
    for (const ClusterImage& image : problem.images) seed ^= image.content_hash;
    return seed;
}

void unregister_all(WorkingModel& model) {
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (model.registered(image)) model.remove_image(image);
    }
}

/// Guard: a global start that places fewer has failed; the cluster is grown from a pair instead.
constexpr std::uint32_t kFewestOfStart = 5;

Error too_few(const WorkingModel& model) {
    return {ErrorCode::kDegenerate, "global reconstruction: only " +
                                        std::to_string(model.registered_count()) +
                                        " images could be placed"};
}

/// Cameras that are believed to be others than those that pairs were verified with: just
/// calibrated, or by earlier models.
std::map<CameraId, Camera> other_than_verified(std::map<CameraId, Camera> calibrated,
                                               const ClusterProblem& problem,
                                               const LocalGraph& graph) {
    for (const auto& [id, believed] : graph.cameras) {
        if (believed.focal_source == FocalSource::kEstimated &&
            believed.params != problem.cameras.at(id).params)
            calibrated.try_emplace(id, believed);
    }
    return calibrated;
}

/// Images with poses from rotations and directions.
struct GlobalPlacement {
    GlobalStart start;
    std::vector<VerifiedPairPtr> pairs;  ///< those that agree with the poses
};

Result<GlobalPlacement> place_images(WorkingModel& model, const ClusterProblem& problem,
                                     const std::vector<VerifiedPairPtr>& pairs,
                                     const SolveOptions& options) {
    const auto rotations = refined_rotations(model, pairs, options);
    if (!rotations.ok()) return rotations.error();
    const GlobalDirections directions =
        find_directions(model, rotations->pairs, rotations->cam_from_cluster, options.global);
    const auto filter = filter_directions(directions.edges, directions.node_count,
                                          options.global.directions, seed_of(problem));
    if (!filter.ok()) return filter.error();
    std::vector<RelativeDirection> kept;
    for (const std::uint32_t edge : filter->kept) kept.push_back(directions.edges[edge]);
    const auto positions = average_positions(kept, directions.node_count, options.global.positions);
    if (!positions.ok()) return positions.error();

    GlobalPlacement placement;
    placement.start.directions = static_cast<std::uint32_t>(directions.pairs.size());
    placement.start.noise_deg = positions->noise_deg;
    for (std::size_t k = 0; k < kept.size() && filter->kept[k] < directions.pairs.size(); ++k) {
        const std::optional<double>& residual_deg = positions->residual_deg[k];
        if (residual_deg && *residual_deg <= options.max_edge_error_deg) {
            placement.pairs.push_back(directions.pairs[filter->kept[k]]);
        }
    }
    placement.start.wrong_directions =
        placement.start.directions - static_cast<std::uint32_t>(placement.pairs.size());
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        const std::optional<Eigen::Vector3d>& centre = positions->position[image];
        if (!centre) continue;
        const Eigen::Quaterniond& rotation = rotations->cam_from_cluster[image];
        model.set_pose(image, {rotation, -(rotation * *centre)});
    }
    return placement;
}

/// Points for those tracks that have none. What of a track does not agree is left out.
void triangulate_tracks(WorkingModel& model, const std::vector<FeatureTrack>& tracks,
                        const TrackOptions& options) {
    for (const FeatureTrack& track : tracks) {
        FeatureTrack open;
        for (const CorrespondenceGraph::Feature& feature : track) {
            if (model.registered(feature.image) &&
                model.point_of(feature) == WorkingModel::kNoPoint)
                open.push_back(feature);
        }
        if (open.size() < 2) continue;
        const auto estimated = estimate_point(model, open, options);
        if (estimated) model.add_point(estimated->position, estimated->inliers);
    }
}

/// Structure from few tracks, and rounds of adjustment with ever smaller errors allowed; then from
/// all.
/// @return adjustments done
Result<std::uint32_t> adjust_in_rounds(WorkingModel& model, const std::vector<FeatureTrack>& tracks,
                                       const RefineContext& context) {
    const SolveOptions& options = context.options;
    std::uint32_t adjustments = 0;
    TrackOptions allowed = options.tracks;
    allowed.max_error_px = std::max(options.global.start_error_px, options.tracks.max_error_px);
    bool last = false;
    while (!last) {
        if (const auto going_on = not_cancelled(context.cancel); !going_on.ok())
            return going_on.error();
        last = allowed.max_error_px <= options.tracks.max_error_px;
        triangulate_tracks(model, tracks, allowed);
        AdjustmentOptions adjustment = options.global.adjustment;
        if (!last) adjustment.function_tolerance = options.global.round_tolerance;
        const auto report =
            adjust(model, full_scope(model, !context.fix_intrinsics), adjustment, context.cancel);
        if (!report.ok()) return report.error();
        ++adjustments;
        filter_tracks(model, {}, allowed);
        allowed.max_error_px = std::max(0.5 * allowed.max_error_px, options.tracks.max_error_px);
    }
    const SolveEffort effort = options.policy.effort_of(model.registered_count());
    const auto all = refine_changed_model(model, effort, context);
    if (!all.ok()) return all.error();
    return adjustments + *all;
}

}  // namespace

Result<GlobalStart> initialize_globally(WorkingModel& model, const SolveContext& context) {
    const auto& [problem, graph, options, cancel] = context;
    if (const auto going_on = not_cancelled(cancel); !going_on.ok()) return going_on.error();
    const auto calibrated = calibrate_shared_cameras(problem, graph, options, cancel);
    if (!calibrated.ok()) return calibrated.error();
    for (const auto& [id, camera] : *calibrated) model.mutable_camera(id) = camera;
    for (const auto& [twin, camera] : problem.twins) model.share_lens(camera);
    auto placement =
        place_images(model, problem,
                     pairs_seen_through(other_than_verified(*calibrated, problem, graph), problem,
                                        graph, options.verification),
                     options);
    if (!placement.ok()) return placement.error();
    const auto adjusted = adjust_in_rounds(
        model, covering_tracks(model, placement->pairs, options.global.adjusted_tracks_per_image),
        context.refining());
    if (!adjusted.ok()) {
        unregister_all(model);
        return adjusted.error();
    }
    SolveOptions strict = options;
    strict.min_observations = std::max(options.min_observations, options.absolute_pose.min_inliers);
    remove_weak_images(model, strict);
    if (model.registered_count() < kFewestOfStart) {
        const Error error = too_few(model);
        unregister_all(model);
        return error;
    }
    placement->start.placed = model.registered_count();
    placement->start.full_adjustments = *adjusted;
    return placement->start;
}

}  // namespace psfm
