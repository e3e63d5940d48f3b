// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/make_problems.h"

#include <algorithm>
#include <functional>
#include <map>

namespace psfm {

std::shared_ptr<const ClusterProblem> make_cluster_problem(const SessionState& state,
                                                           const SessionConfig& config,
                                                           const ClusterEntry& entry, bool settle) {
    auto problem = std::make_shared<ClusterProblem>();
    problem->cluster = entry.id;
    problem->topology = entry.topology;
    for (const RecycledModel& recycled : entry.material)
        problem->recycled.push_back(recycled.model);
    std::ranges::stable_sort(problem->recycled, std::ranges::greater(),
                             [](const auto& model) { return model->images.size(); });
    problem->recycled_state = entry.material_state;
    problem->fix_intrinsics = config.fix_intrinsics;
    problem->settle = settle;
    problem->seed = config.seed;
    const std::vector<ImageId> images = state.clusters.images_of(entry);
    for (const ImageId id : images) {
        const Image& image = state.images[index_of(id)];
        problem->images.push_back(
            {id, image.camera, image.metadata.content_hash, state.keypoints[index_of(id)]});
        problem->cameras.emplace(image.camera, state.cameras.at(image.camera));
        for (const ViewGraph::Edge& edge : state.view_graph.edges(id)) {
            if (edge.neighbor > id && std::ranges::binary_search(images, edge.neighbor))
                problem->pairs.push_back(edge.pair);
        }
    }
    return problem;
}

std::shared_ptr<const MergeProblem> make_merge_problem(const SessionState& state) {
    auto problem = std::make_shared<MergeProblem>();
    std::map<std::pair<ClusterId, ClusterId>, std::vector<VerifiedPairPtr>> between;
    for (const auto& [id, entry] : state.clusters.entries()) {
        problem->clusters.push_back({id, entry.revision, entry.model});
        if (!entry.model) continue;
        for (const RegisteredImage& image : entry.model->images) {
            if (state.clusters.of(image.image).id != id) continue;
            for (const ViewGraph::Edge& edge : state.view_graph.edges(image.image)) {
                const ClusterEntry& other = state.clusters.of(edge.neighbor);
                if (id < other.id && other.model && other.model->find(edge.neighbor) != nullptr)
                    between[{id, other.id}].push_back(edge.pair);
            }
        }
    }
    for (auto& [clusters, edges] : between) {
        std::ranges::sort(edges, {}, [](const VerifiedPairPtr& pair) { return pair->pair; });
        problem->pairs.push_back({clusters.first, clusters.second, std::move(edges)});
    }
    problem->known = state.constraints;
    problem->previous = state.scene;
    problem->evidence = evidence_of(state.images);
    return problem;
}

}  // namespace psfm
