// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/close_loops.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "graph/sorted_unique.h"
#include "stages/algorithms/alignment/rigid_groups.h"
#include "stages/reconstruction/build/refine_model.h"
#include "stages/reconstruction/checks/open_edges.h"
#include "stages/reconstruction/checks/separate_places.h"
#include "stages/reconstruction/model/cancelled.h"

namespace psfm {
namespace {

/// Times that edges which stay open are left out before the others are asked once more. Ours.
constexpr int kMaxPasses = 3;  // Guard: ends the passes

/// What pulls at a model's images.
struct LoopEdges {
    std::vector<PoseGraphEdge> open;
    std::vector<PoseGraphEdge> holding;
};

/// How a model is moved to close its loops.
struct Closing {
    std::vector<Sim3> model_from_image;   ///< by local image: where its surroundings go
    std::vector<std::uint32_t> strained;  ///< images that moved against others, ascending
};

double residual_of(const PoseGraphEdge& edge, const std::vector<Sim3>& poses) {
    return pose_graph_residual(edge, poses[edge.a], poses[edge.b]);
}

std::vector<std::uint32_t> strained_images(const LoopEdges& edges, const std::vector<Sim3>& poses,
                                           double min_strain) {
    std::vector<std::uint32_t> images;
    for (const PoseGraphEdge& edge : edges.holding) {
        if (residual_of(edge, poses) > min_strain) images.insert(images.end(), {edge.a, edge.b});
    }
    for (const PoseGraphEdge& edge : edges.open) images.insert(images.end(), {edge.a, edge.b});
    sort_unique(images);
    return images;
}

/// Poses along the strongest edges, so that what is wrong stays at few places, as where two models
/// were joined. Images that hold together move as one at first, and each for itself where something
/// is strained.
Result<std::vector<Sim3>> solve_at_breaks(const LoopEdges& edges,
                                          std::span<const PoseGraphEdge> all, std::size_t images,
                                          PoseGraphOptions pose_graph, const LoopOptions& options) {
    pose_graph.max_residual = std::numeric_limits<double>::max();
    std::vector<std::uint8_t> is_alone(images, 0);
    for (const PoseGraphEdge& edge : edges.open) is_alone[edge.a] = is_alone[edge.b] = 1;
    std::vector<Sim3> poses;
    for (const bool last : {false, true}) {
        const RigidGroups groups = group_rigidly(edges.holding, is_alone, options.images_per_group);
        auto solved = solve_cluster_poses(groups.edges_between(all), groups.sizes, pose_graph);
        if (!solved.ok()) return solved.error();
        poses = groups.by_node(solved->component_from_cluster);
        if (last) break;
        std::vector<std::uint8_t> is_strained(groups.sizes.size(), 0);
        for (const std::uint32_t image : strained_images(edges, poses, options.min_strain))
            is_strained[groups.group_of[image]] = 1;
        for (std::size_t image = 0; image < images; ++image)
            is_alone[image] |= is_strained[groups.group_of[image]];
    }
    return poses;
}

/// Poses of the images, each a frame of its own, that bring together what the open edges ask for.
/// @param at_breaks  at few places; else a little of it everywhere, as after drift
Result<std::vector<Sim3>> solve_poses(const LoopEdges& edges, std::size_t images, bool at_breaks,
                                      const LoopOptions& options) {
    std::vector<PoseGraphEdge> all = edges.holding;
    all.insert(all.end(), edges.open.begin(), edges.open.end());
    PoseGraphOptions pose_graph;
    pose_graph.max_iterations = options.max_iterations;
    if (at_breaks) return solve_at_breaks(edges, all, images, pose_graph, options);
    pose_graph.huber_scale = options.drift_loss_scale;
    const std::vector<std::size_t> sizes(images, 1);
    return refine_cluster_poses(all, sizes, std::vector<Sim3>(images), pose_graph);
}

using MaybeClosing = std::optional<Closing>;

/// Nothing when too few edges close, or when these tear what holds.
/// @errors those of solve_cluster_poses, kCancelled
Result<MaybeClosing> find_closing(const WorkingModel& model, LoopEdges edges, bool at_breaks,
                                  const SolveContext& context) {
    const LoopOptions& options = context.options.loops;
    for (int pass = 0; pass < kMaxPasses && edges.open.size() >= options.min_open_edges; ++pass) {
        if (const auto going_on = not_cancelled(context.cancel); !going_on.ok())
            return going_on.error();
        auto poses = solve_poses(edges, model.image_count(), at_breaks, options);
        if (!poses.ok()) return poses.error();
        const auto is_far = [&](const PoseGraphEdge& edge) {
            return residual_of(edge, *poses) > options.max_residual;
        };
        // Those that the others do not let close are wrong, and pull at the model in vain.
        if (std::erase_if(edges.open, is_far) > 0) continue;
        const auto torn = static_cast<double>(std::ranges::count_if(edges.holding, is_far));
        if (torn > options.max_torn * static_cast<double>(edges.open.size())) return MaybeClosing();
        std::vector<std::uint32_t> strained = strained_images(edges, *poses, options.min_strain);
        return MaybeClosing(Closing{*std::move(poses), std::move(strained)});
    }
    return MaybeClosing();
}

/// Points go where their images go, in the mean.
void move(WorkingModel& model, const std::vector<Sim3>& model_from_image) {
    for (std::uint32_t p = 0; p < model.points().size(); ++p) {
        const WorkingModel::Point& point = model.points()[p];
        if (!point.alive()) continue;
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const WorkingModel::Feature& feature : point.track)
            sum += model_from_image[feature.image] * point.position;
        model.set_position(p, sum / static_cast<double>(point.track.size()));
    }
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (model.registered(image))
            model.set_pose(image, transform_pose(model.pose(image), model_from_image[image]));
    }
}

std::size_t observations_of(const WorkingModel& model) {
    std::size_t count = 0;
    for (const WorkingModel::Point& point : model.points()) count += point.track.size();
    return count;
}

bool shows_places(const WorkingModel& model, const SolveContext& context) {
    return !separate_places(model.save(), pairs_of(context.problem), context.options.places)
                .empty();
}

}  // namespace

Result<LoopClosing> close_loops(WorkingModel& model, const SolveContext& context) {
    const LoopClosing nothing;
    const LoopOptions& loops = context.options.loops;
    if (loops.min_open_edges == 0) return nothing;
    LoopEdges edges{find_open_edges(model, context.graph, loops), {}};
    if (edges.open.size() < loops.min_open_edges) return nothing;
    edges.holding = find_holding_edges(model, context.graph, loops);
    MaybeClosing closing;
    for (const bool at_breaks : {true, false}) {
        auto found = find_closing(model, edges, at_breaks, context);
        if (!found.ok()) return found.error();
        closing = *std::move(found);
        if (closing) break;
    }
    if (!closing) return nothing;
    WorkingModel trial = model;
    move(trial, closing->model_from_image);
    const auto adjustments = refine_around(trial, closing->strained, 0, context.refining());
    if (!adjustments.ok()) {
        // Expected: what cannot be adjusted once it is closed stays open
        if (adjustments.error().code == ErrorCode::kCancelled) return adjustments.error();
        return nothing;
    }
    const auto before = static_cast<double>(observations_of(model));
    const auto after = static_cast<double>(observations_of(trial));
    if (trial.registered_count() < model.registered_count() ||
        after < (1.0 - loops.max_lost_observations) * before)
        return nothing;
    const bool shows_one_place = !shows_places(trial, context);
    if (!shows_one_place && !shows_places(model, context)) return nothing;
    model = std::move(trial);
    return LoopClosing{*adjustments, shows_one_place};
}

}  // namespace psfm
