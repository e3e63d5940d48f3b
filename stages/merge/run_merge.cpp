// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/run_merge.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "graph/sorted_unique.h"
#include "stages/algorithms/alignment/cluster_index.h"
#include "stages/algorithms/alignment/estimate_cluster_constraint.h"
#include "stages/algorithms/math/in_parallel.h"
#include "stages/merge/geo/place_components.h"

namespace psfm {
namespace {

Error invalid_problem(const std::string& what) {
    return {ErrorCode::kInvalidArgument, "merge: " + what};
}

bool has_model(const MergeCluster& cluster) {
    return cluster.model != nullptr && !cluster.model->empty();
}

const MergeCluster* find_cluster(const MergeProblem& problem, ClusterId id) {
    const auto found = std::ranges::lower_bound(problem.clusters, id, {}, &MergeCluster::id);
    return found != problem.clusters.end() && found->id == id ? &*found : nullptr;
}

Result<void> check(const MergeProblem& problem) {
    if (!std::ranges::is_sorted(problem.clusters, std::ranges::less_equal{}, &MergeCluster::id)) {
        return invalid_problem("clusters must be ascending by id, each once");
    }
    if (!std::ranges::is_sorted(problem.evidence, std::ranges::less_equal{},
                                &ImageEvidence::image)) {
        return invalid_problem("evidence must be ascending by image, each once");
    }
    const auto key = [](const ClusterPairEdgesPtr& pair) { return std::pair(pair->a, pair->b); };
    if (!std::ranges::is_sorted(problem.pairs, std::ranges::less_equal{}, key)) {
        return invalid_problem("pairs of clusters must be ascending, each once");
    }
    for (const ClusterPairEdgesPtr& pair : problem.pairs) {
        const bool known =
            find_cluster(problem, pair->a) != nullptr && find_cluster(problem, pair->b) != nullptr;
        if (pair->a < pair->b && known) continue;
        return invalid_problem("pair of clusters " + std::to_string(index_of(pair->a)) + " and " +
                               std::to_string(index_of(pair->b)) +
                               (known ? " is not ascending" : " names an unknown cluster"));
    }
    return {};
}

/// A pair of clusters with models, and its constraint: when it is known already, as it is.
struct PairTask {
    ClusterPairEdgesPtr edges;
    const MergeCluster* a = nullptr;
    const MergeCluster* b = nullptr;
    ClusterConstraint constraint;
    const ClusterConstraint* before = nullptr;  ///< of earlier revisions; null: there is none
    bool known = false;
};

std::vector<PairTask> list_pairs(const MergeProblem& problem) {
    std::map<std::pair<ClusterId, ClusterId>, const ClusterConstraint*> known;
    for (const ClusterConstraint& constraint : problem.known) {
        known[{constraint.a, constraint.b}] = &constraint;
    }
    std::vector<PairTask> tasks;
    for (const ClusterPairEdgesPtr& pair : problem.pairs) {
        PairTask task;
        task.edges = pair;
        task.a = find_cluster(problem, pair->a);
        task.b = find_cluster(problem, pair->b);
        if (!has_model(*task.a) || !has_model(*task.b)) continue;
        const auto found = known.find({pair->a, pair->b});
        if (found != known.end()) {
            task.before = found->second;
            task.known = task.before->revision_a == task.a->revision &&
                         task.before->revision_b == task.b->revision &&
                         task.before->edges_given == pair->edges.size() &&
                         task.before->edges_hash == pair->hash;
        }
        if (task.known) task.constraint = *task.before;
        if (pair->edges.empty()) {  // weak ones alone: they tie nothing, whatever the models are
            task.known = true;
            task.constraint.a = pair->a;
            task.constraint.b = pair->b;
        }
        tasks.push_back(std::move(task));
    }
    return tasks;
}

void estimate_unknown(std::vector<PairTask>& tasks, const ClusterConstraintOptions& options) {
    // A model is indexed once for all its pairs, and only if one of them is new.
    std::map<const MergeCluster*, std::vector<ImageId>> asked;
    for (const PairTask& task : tasks) {
        if (task.known) continue;
        for (const MergeCluster* cluster : {task.a, task.b}) {
            std::vector<ImageId>& images = asked[cluster];
            for (const VerifiedPairPtr& edge : task.edges->edges) {
                images.push_back(edge->pair.first);
                images.push_back(edge->pair.second);
            }
        }
    }
    std::unordered_map<const MergeCluster*, ClusterIndex> indices;
    for (auto& [cluster, images] : asked) {
        std::erase_if(images, [&](ImageId i) { return cluster->model->find(i) == nullptr; });
        sort_unique(images);
        indices.emplace(cluster, ClusterIndex(*cluster->model, images));
    }
    for (PairTask& task : tasks) {
        if (task.known) continue;
        task.constraint = estimate_cluster_constraint(indices.at(task.a), indices.at(task.b),
                                                      task.edges->edges, options, task.before);
        task.constraint.a = task.a->id;
        task.constraint.b = task.b->id;
        task.constraint.revision_a = task.a->revision;
        task.constraint.revision_b = task.b->revision;
        task.constraint.edges_given = static_cast<std::uint32_t>(task.edges->edges.size());
        task.constraint.edges_hash = task.edges->hash;
    }
}

/// The clusters with a model, and what ties them.
ClusterNetwork network_of(const MergeProblem& problem, const std::vector<PairTask>& tasks) {
    ClusterNetwork network;
    std::map<ClusterId, std::uint32_t> number;
    for (const MergeCluster& cluster : problem.clusters) {
        if (!has_model(cluster)) continue;
        number[cluster.id] = static_cast<std::uint32_t>(network.clusters.size());
        network.clusters.push_back(&cluster);
        network.cameras.push_back(cluster.cameras);
    }
    for (const PairTask& task : tasks) {
        network.links.push_back({number.at(task.constraint.a), number.at(task.constraint.b),
                                 task.edges, &task.constraint});
    }
    in_parallel(network.cameras.size(), [&](std::size_t c) {
        if (!network.cameras[c]) network.cameras[c] = cameras_of(*network.clusters[c]->model);
    });
    return network;
}

/// The components; of the result, what the next merge is to know; which of the constraints are
/// used.
Result<std::vector<Component>> solve_components(const MergeProblem& problem,
                                                std::vector<PairTask>& tasks,
                                                const MergeOptions& options, MergeResult& result) {
    const ClusterNetwork network = network_of(problem, tasks);
    for (std::size_t c = 0; c < network.clusters.size(); ++c)
        result.cameras.emplace_back(network.clusters[c]->id, network.cameras[c]);
    auto solved = consistent_poses(network, problem.known_poses, options);
    if (!solved.ok()) return solved.error();
    const ClusterPoses& poses = solved->poses;
    for (std::size_t t = 0; t < tasks.size(); ++t) tasks[t].constraint.used = poses.used[t];
    std::vector<Component> components(poses.component_count);
    for (std::size_t c = 0; c < network.clusters.size(); ++c) {
        Component& component = components[poses.component[c]];
        component.clusters.push_back(network.clusters[c]);
        component.component_from_cluster.push_back(poses.component_from_cluster[c]);
        component.placed += network.clusters[c]->model->images.size();
    }
    result.known_poses = std::move(solved->known);
    result.parts_solved = solved->parts_solved;
    std::ranges::sort(components, [](const Component& x, const Component& y) {
        return std::tuple(y.placed, x.clusters.front()->id) <
               std::tuple(x.placed, y.clusters.front()->id);
    });
    return components;
}

/// Known constraints of pairs that have no two models at present, though both clusters are there:
/// a cluster that most images have left shows no model until it is solved again, and some of what
/// was known of it will hold then. @param tasks  ascending
std::vector<ClusterConstraint> set_aside(const MergeProblem& problem,
                                         const std::vector<PairTask>& tasks) {
    std::vector<ClusterConstraint> aside;
    const auto key = [](const PairTask& task) { return std::pair(task.edges->a, task.edges->b); };
    for (const ClusterConstraint& constraint : problem.known) {
        const std::pair pair(constraint.a, constraint.b);
        if (std::ranges::binary_search(tasks, pair, {}, key)) continue;
        if (find_cluster(problem, pair.first) == nullptr ||
            find_cluster(problem, pair.second) == nullptr)
            continue;
        aside.push_back(constraint);
        aside.back().used = false;
    }
    return aside;
}

}  // namespace

std::vector<ClusterId> clusters_to_look_into(const MergeProblem& problem) {
    std::set<ClusterId> clusters;
    for (const PairTask& task : list_pairs(problem)) {
        if (!task.known) clusters.insert({task.a->id, task.b->id});
    }
    return {clusters.begin(), clusters.end()};
}

Result<MergeResult> run_merge(const MergeProblem& problem, const MergeOptions& options) {
    if (auto valid = validate(options); !valid.ok()) return valid.error();
    if (auto valid = check(problem); !valid.ok()) return valid.error();

    std::vector<PairTask> tasks = list_pairs(problem);
    estimate_unknown(tasks, options.constraint);
    MergeResult result;
    auto components = solve_components(problem, tasks, options, result);
    if (!components.ok()) return components.error();

    result.set_aside = set_aside(problem, tasks);
    for (PairTask& task : tasks) {
        result.reused += task.known ? 1 : 0;
        result.dropped += task.constraint.accepted() && !task.constraint.used ? 1 : 0;
        result.constraints.push_back(std::move(task.constraint));
    }
    PlacedComponents placed = place_components(*components, problem.previous.get(), problem.anchors,
                                               problem.evidence, options);
    result.places = std::move(placed.places);
    result.datum = placed.datum;
    for (const Component& component : *components) {
        const Sim3& world_from_component =
            result.places[result.effective_clusters].world_from_component;
        for (std::size_t c = 0; c < component.clusters.size(); ++c) {
            result.placements.push_back({component.clusters[c]->id,
                                         world_from_component * component.component_from_cluster[c],
                                         result.effective_clusters});
        }
        ++result.effective_clusters;
    }
    std::uint32_t number = result.effective_clusters;
    for (const MergeCluster& cluster : problem.clusters) {
        if (!has_model(cluster)) result.placements.push_back({cluster.id, Sim3{}, number++});
    }
    std::ranges::sort(result.placements, {}, &ClusterPlacement::id);
    return result;
}

}  // namespace psfm
