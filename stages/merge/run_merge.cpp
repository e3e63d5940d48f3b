// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/run_merge.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

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

#include "stages/merge/cluster_index.h"
#include "stages/merge/cluster_pose_graph.h"
#include "stages/merge/contract_signed_graph.h"
#include "stages/merge/estimate_cluster_constraint.h"
#include "stages/merge/find_contradictions.h"
#include "stages/merge/place_components.h"

namespace psfm {
namespace {

Error invalid(const std::string& what) {
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
        return invalid("clusters must be ascending by id, each once");
    }
    if (!std::ranges::is_sorted(problem.evidence, std::ranges::less_equal{},
                                &ImageEvidence::image)) {
        return invalid("evidence must be ascending by image, each once");
    }
    const auto key = [](const ClusterPairEdges& pair) { return std::pair(pair.a, pair.b); };
    if (!std::ranges::is_sorted(problem.pairs, std::ranges::less_equal{}, key)) {
        return invalid("pairs of clusters must be ascending, each once");
    }
    for (const ClusterPairEdges& pair : problem.pairs) {
        const std::string name = "pair of clusters " + std::to_string(index_of(pair.a)) + " and " +
                                 std::to_string(index_of(pair.b));
        if (pair.a >= pair.b) return invalid(name + " is not ascending");
        if (find_cluster(problem, pair.a) == nullptr || find_cluster(problem, pair.b) == nullptr) {
            return invalid(name + " names an unknown cluster");
        }
        if (std::ranges::find(pair.edges, nullptr) != pair.edges.end()) {
            return invalid(name + " has a null edge");
        }
    }
    return {};
}

/// Sum over the pairs of a mix of their numbers: the same for every order.
std::uint64_t hash_of(const std::vector<VerifiedPairPtr>& edges) {
    std::uint64_t sum = 0;
    for (const VerifiedPairPtr& edge : edges) {
        std::uint64_t value = (static_cast<std::uint64_t>(index_of(edge->pair.first)) << 32U) |
                              index_of(edge->pair.second);
        value = (value ^ (value >> 31U)) * 0x7FB5D329728EA185ULL;
        value = (value ^ (value >> 27U)) * 0x81DADEF4BC2DD44DULL;
        sum += value ^ (value >> 33U);
    }
    return sum;
}

/// A pair of clusters with models, and its constraint: when it is known already, as it is.
struct PairTask {
    const ClusterPairEdges* edges = nullptr;
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
    for (const ClusterPairEdges& pair : problem.pairs) {
        PairTask task;
        task.edges = &pair;
        task.a = find_cluster(problem, pair.a);
        task.b = find_cluster(problem, pair.b);
        if (!has_model(*task.a) || !has_model(*task.b)) continue;
        const std::uint64_t hash = hash_of(pair.edges);
        const auto found = known.find({pair.a, pair.b});
        if (found != known.end()) {
            task.before = found->second;
            task.known = task.before->revision_a == task.a->revision &&
                         task.before->revision_b == task.b->revision &&
                         task.before->edges_given == pair.edges.size() &&
                         task.before->edges_hash == hash;
        }
        if (task.known) task.constraint = *task.before;
        task.constraint.edges_hash = hash;
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
        std::ranges::sort(images);
        images.erase(std::unique(images.begin(), images.end()), images.end());
        indices.emplace(cluster, ClusterIndex(*cluster->model, images));
    }
    for (PairTask& task : tasks) {
        if (task.known) continue;
        const std::uint64_t hash = task.constraint.edges_hash;
        task.constraint = estimate_cluster_constraint(indices.at(task.a), indices.at(task.b),
                                                      task.edges->edges, options, task.before);
        task.constraint.a = task.a->id;
        task.constraint.b = task.b->id;
        task.constraint.revision_a = task.a->revision;
        task.constraint.revision_b = task.b->revision;
        task.constraint.edges_given = static_cast<std::uint32_t>(task.edges->edges.size());
        task.constraint.edges_hash = hash;
    }
}

/// The pose graph of the clusters with a model, and what it is made from.
struct ClusterGraph {
    std::vector<const MergeCluster*> clusters;  ///< ascending by id
    std::vector<std::size_t> sizes;
    std::vector<std::shared_ptr<const std::vector<double>>> depths;  ///< mean_depths() of each
    std::vector<PoseGraphEdge> edges;
    std::vector<ClusterConstraint*> constraints;  ///< by edge
};

ClusterGraph graph_of(const MergeProblem& problem, std::vector<PairTask>& tasks) {
    ClusterGraph graph;
    std::map<ClusterId, std::uint32_t> number;
    for (const MergeCluster& cluster : problem.clusters) {
        if (!has_model(cluster)) continue;
        number[cluster.id] = static_cast<std::uint32_t>(graph.clusters.size());
        graph.clusters.push_back(&cluster);
        graph.sizes.push_back(cluster.model->images.size());
        graph.depths.push_back(cluster.depths);
    }
    for (PairTask& task : tasks) {
        ClusterConstraint& constraint = task.constraint;
        constraint.used = false;
        if (!constraint.accepted()) continue;
        graph.edges.push_back({number.at(constraint.a), number.at(constraint.b),
                               constraint.b_from_a, constraint.anchor_in_a, constraint.extent_in_a,
                               static_cast<double>(constraint.inliers)});
        graph.constraints.push_back(&constraint);
    }
    return graph;
}

std::vector<ImagePair> image_pairs(const MergeProblem& problem) {
    std::vector<ImagePair> pairs;
    for (const ClusterPairEdges& between : problem.pairs) {
        for (const VerifiedPairPtr& edge : between.edges) pairs.push_back(edge->pair);
    }
    std::ranges::sort(pairs);
    return pairs;
}

/// Clusters that contradict each other where the constraints put them.
std::vector<SignedEdge> contradictions_of(const ClusterGraph& graph, const ClusterPoses& poses,
                                          std::span<const ImagePair> pairs,
                                          const ClusterConstraintOptions& options) {
    /// No constraint outweighs a contradiction.
    constexpr double kNever = -1e12;
    std::vector<SignedEdge> contradictions;
    for (std::uint32_t component = 0; component < poses.component_count; ++component) {
        std::vector<std::uint32_t> numbers;
        std::vector<PlacedModel> models;
        for (std::uint32_t c = 0; c < graph.clusters.size(); ++c) {
            if (poses.component[c] != component) continue;
            numbers.push_back(c);
            models.push_back({graph.clusters[c]->model.get(), *graph.depths[c],
                              poses.component_from_cluster[c]});
        }
        for (const auto& [a, b] : find_contradictions(models, pairs, options))
            contradictions.push_back({numbers[a], numbers[b], kNever});
    }
    return contradictions;
}

/// Leaves out the constraints between groups of clusters that contradict each other (ours):
/// clusters are put together by the constraints with most inliers first, as long as none
/// contradicts another.
void keep_consistent(ClusterGraph& graph, std::span<const SignedEdge> contradictions) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> weights;
    for (const PoseGraphEdge& edge : graph.edges)
        weights[std::minmax(edge.a, edge.b)] += edge.weight;
    for (const SignedEdge& edge : contradictions) weights[{edge.first, edge.second}] = edge.weight;
    std::vector<SignedEdge> edges;
    edges.reserve(weights.size());
    for (const auto& [ends, weight] : weights) edges.push_back({ends.first, ends.second, weight});
    const std::vector<std::uint32_t> group = contract_signed_graph(graph.clusters.size(), edges);
    std::size_t kept = 0;
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
        if (group[graph.edges[e].a] != group[graph.edges[e].b]) continue;
        graph.edges[kept] = graph.edges[e];
        graph.constraints[kept++] = graph.constraints[e];
    }
    graph.edges.resize(kept);
    graph.constraints.resize(kept);
}

Result<ClusterPoses> consistent_poses(ClusterGraph& graph, std::span<const ImagePair> pairs,
                                      const MergeOptions& options) {
    /// Each time that it says so, a constraint at least is left out.
    const auto leave_out = [&](const ClusterPoses& poses) {
        const auto contradictions = contradictions_of(graph, poses, pairs, options.constraint);
        const std::size_t before = graph.edges.size();
        if (!contradictions.empty()) keep_consistent(graph, contradictions);
        return graph.edges.size() < before;
    };
    // Most folds are seen without solving anything: one wrong constraint of the tree is enough.
    while (leave_out(poses_along_tree(graph.edges, graph.sizes))) {
    }
    while (true) {
        auto poses = solve_cluster_poses(graph.edges, graph.sizes, options.pose_graph);
        if (!poses || !leave_out(*poses)) return poses;
    }
}

/// The components; of the result, the depths.
Result<std::vector<Component>> solve_components(const MergeProblem& problem,
                                                std::vector<PairTask>& tasks,
                                                const MergeOptions& options, MergeResult& result) {
    ClusterGraph graph = graph_of(problem, tasks);
    // Isolated: a version is not to wait for a solve that this thread takes up in between.
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(std::size_t{0}, graph.depths.size(), [&](std::size_t c) {
            if (graph.depths[c]) return;
            graph.depths[c] =
                std::make_shared<const std::vector<double>>(mean_depths(*graph.clusters[c]->model));
        });
    });
    for (std::size_t c = 0; c < graph.clusters.size(); ++c)
        result.depths.emplace_back(graph.clusters[c]->id, graph.depths[c]);
    const auto poses = consistent_poses(graph, image_pairs(problem), options);
    if (!poses) return poses.error();
    for (std::size_t e = 0; e < graph.edges.size(); ++e)
        graph.constraints[e]->used = poses->used[e];
    std::vector<Component> components(poses->component_count);
    for (std::size_t c = 0; c < graph.clusters.size(); ++c) {
        Component& component = components[poses->component[c]];
        component.clusters.push_back(graph.clusters[c]);
        component.component_from_cluster.push_back(poses->component_from_cluster[c]);
        component.placed += graph.sizes[c];
    }
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
    if (auto valid = validate(options); !valid) return valid.error();
    if (auto valid = check(problem); !valid) return valid.error();

    std::vector<PairTask> tasks = list_pairs(problem);
    estimate_unknown(tasks, options.constraint);
    MergeResult result;
    auto components = solve_components(problem, tasks, options, result);
    if (!components) return components.error();

    result.set_aside = set_aside(problem, tasks);
    for (PairTask& task : tasks) {
        result.reused += task.known ? 1 : 0;
        result.dropped += task.constraint.accepted() && !task.constraint.used ? 1 : 0;
        result.constraints.push_back(std::move(task.constraint));
    }
    PlacedComponents placed =
        place_components(*components, problem.previous.get(), problem.evidence, options);
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
