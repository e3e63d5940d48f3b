// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/make_problems.h"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "graph/camera_lens.h"
#include "stages/features/cameras/assign_camera.h"

namespace psfm {
namespace {

/// Intrinsics of those cameras of a problem that none of its recycled models has, from the
/// published model that has most images of each.
std::map<CameraId, Camera> calibrated_elsewhere(const SessionState& state,
                                                const ClusterProblem& problem,
                                                std::uint32_t images_needed) {
    std::map<CameraId, std::uint32_t> images_behind;
    for (const auto& [id, camera] : problem.cameras) {
        const bool known = std::ranges::any_of(
            problem.recycled, [&](const auto& model) { return model->cameras.contains(id); });
        if (!known) images_behind[id] = images_needed - 1;
    }
    std::map<CameraId, Camera> calibrated;
    if (images_behind.empty()) return calibrated;
    // As published, not as solved since: clusters that one image makes dirty may not depend on
    // which of them was solved first, also when a process dies between two of them.
    for (const auto& shown : state.scene->clusters) {
        if (!shown->model || !state.clusters.entries().contains(shown->id)) continue;
        std::map<CameraId, std::uint32_t> counts;
        for (const RegisteredImage& image : shown->model->images) ++counts[image.camera];
        for (auto& [id, most] : images_behind) {
            if (counts[id] <= most) continue;
            most = counts[id];
            calibrated[id] = shown->model->cameras.at(id);
        }
    }
    return calibrated;
}

/// Cameras by the kind of their photographs, where there are several of a kind: see camera_kind.
using Kinds = std::map<std::string, std::set<CameraId>>;

Kinds kinds_of(const SessionState& state, const SessionConfig& config,
               std::span<const ImageId> images) {
    Kinds kinds;
    std::set<CameraId> seen;
    for (const ImageId id : images) {
        const Image& image = state.photographs.images[index_of(id)];
        if (!seen.insert(image.camera).second || config.given_cameras.contains(image.name))
            continue;
        const std::string kind = camera_kind(config.camera_sharing, image.metadata);
        if (!kind.empty()) kinds[kind].insert(image.camera);
    }
    std::erase_if(kinds, [](const auto& kind) { return kind.second.size() < 2; });
    return kinds;
}

/// The camera that most images of one kind share in a published model.
std::optional<Camera> most_common_camera(const SessionState& state, CameraSharing sharing,
                                         const std::string& kind, std::uint32_t images_needed) {
    std::optional<Camera> best;
    std::uint32_t most = images_needed - 1;
    for (const auto& shown : state.scene->clusters) {
        if (!shown->model || !state.clusters.entries().contains(shown->id)) continue;
        std::map<CameraId, std::uint32_t> counts;
        for (const RegisteredImage& image : shown->model->images) ++counts[image.camera];
        for (const RegisteredImage& image : shown->model->images) {
            const std::uint32_t count = std::exchange(counts[image.camera], 0);
            if (count <= most ||
                camera_kind(sharing, state.photographs.images[index_of(image.image)].metadata) !=
                    kind)
                continue;
            most = count;
            best = shown->model->cameras.at(image.camera);
        }
    }
    return best;
}

/// The same for cameras of a kind that no recycled model has any of.
void calibrate_kinds(const SessionState& state, const SessionConfig& config, const Kinds& kinds,
                     std::uint32_t images_needed, ClusterProblem& problem) {
    for (const auto& [kind, cameras] : kinds) {
        const bool known = std::ranges::any_of(problem.recycled, [&](const auto& model) {
            return std::ranges::any_of(model->images, [&](const RegisteredImage& image) {
                return cameras.contains(state.photographs.images[index_of(image.image)].camera);
            });
        });
        const auto common =
            known ? std::nullopt
                  : most_common_camera(state, config.camera_sharing, kind, images_needed);
        if (!common) continue;
        for (const CameraId camera : cameras) {
            const Camera& own = problem.cameras.at(camera);
            const bool is_turned = own.width != common->width;
            problem.calibrated[camera] = is_turned ? with_lens_of(own, *common) : *common;
        }
    }
}

}  // namespace

std::shared_ptr<const ClusterProblem> make_cluster_problem(const SessionState& state,
                                                           const SessionConfig& config,
                                                           const SolveOptions& options,
                                                           const ClusterEntry& entry, bool settle) {
    auto problem = std::make_shared<ClusterProblem>();
    problem->cluster = entry.id;
    problem->topology = entry.membership.topology;
    for (const RecycledModel& recycled : entry.material.models)
        problem->recycled.push_back(recycled.model);
    std::ranges::stable_sort(problem->recycled, std::ranges::greater(),
                             [](const auto& model) { return model->images.size(); });
    problem->recycled_state = entry.material.state;
    problem->fix_intrinsics = config.fix_intrinsics;
    problem->settle = settle;
    problem->concluding = settle || state.concluding;
    problem->seed = config.seed;
    const std::vector<ImageId> images = state.clusters.images_of(entry);
    problem->view_graph = state.view_graph;
    problem->images.reserve(images.size());
    for (const ImageId id : images) {
        const Image& image = state.photographs.images[index_of(id)];
        problem->images.push_back({id, image.camera, image.metadata.content_hash,
                                   state.photographs.keypoints[index_of(id)]});
        if (!problem->cameras.contains(image.camera))
            problem->cameras.emplace(image.camera, state.photographs.cameras.at(image.camera));
    }
    if (config.fix_intrinsics) return problem;
    const Kinds kinds = kinds_of(state, config, images);
    for (std::uint32_t number = 0; const auto& [kind, cameras] : kinds) {
        for (const CameraId camera : cameras) problem->alike[camera] = number;
        ++number;
    }
    problem->calibrated = calibrated_elsewhere(state, *problem, options.images_to_hand_on);
    calibrate_kinds(state, config, kinds, options.images_to_hand_on, *problem);
    return problem;
}

std::shared_ptr<MergeProblem> make_merge_problem(SessionState& state, const SessionConfig& config,
                                                 const MergeOptions& options) {
    auto problem = std::make_shared<MergeProblem>();
    for (const auto& [id, entry] : state.clusters.entries())
        problem->clusters.push_back(
            {id, entry.published.revision, entry.published.model, entry.published.cameras});
    problem->pairs =
        state.merges.between.update(state.clusters, state.view_graph, options.constraint);
    problem->known = state.merges.constraints;
    problem->known_poses = state.merges.known_poses;
    problem->previous = state.scene;
    problem->anchors = config.anchors;
    const auto is_located = [](const Image& image) { return image.metadata.gps.has_value(); };
    // Orientations alone say nothing.
    if (std::ranges::any_of(state.photographs.images, is_located))
        problem->evidence = evidence_of(state.photographs.images);
    return problem;
}

std::vector<UnplacedImage> unplaced_images(const SessionState& state, const SessionConfig& config) {
    std::vector<UnplacedImage> unplaced;
    for (const auto& [id, entry] : state.clusters.entries()) {
        if (!is_solved(entry) || entry.published.revision == 0) continue;
        for (const ImageId image_id : state.clusters.unplaced_of(entry)) {
            if (state.clusters.hosts().is_adopted(image_id)) continue;
            const Image& image = state.photographs.images[index_of(image_id)];
            UnplacedImage candidate{image_id,
                                    id,
                                    image.camera,
                                    state.photographs.cameras.at(image.camera),
                                    config.fix_intrinsics,
                                    config.seed ^ image.metadata.content_hash,
                                    state.photographs.keypoints[index_of(image_id)],
                                    {}};
            bool elsewhere = false;
            bool has_changed = !is_shown(entry, *state.scene);
            for (const ViewGraph::Edge& edge : state.view_graph.edges(image_id)) {
                if (edge.weight == 0.0) continue;
                const ClusterEntry& other = state.clusters.of(edge.neighbor);
                if (!other.published.model || other.published.model->find(edge.neighbor) == nullptr)
                    continue;
                candidate.edges.push_back({edge.pair, other.id});
                elsewhere = elsewhere || other.id != id;
                has_changed = has_changed || !is_shown(other, *state.scene);
            }
            if (elsewhere && has_changed) unplaced.push_back(std::move(candidate));
        }
    }
    std::ranges::sort(unplaced, {}, &UnplacedImage::id);
    return unplaced;
}

}  // namespace psfm
