// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/consistency/consistent_poses.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "stages/algorithms/math/contract_signed_graph.h"
#include "stages/algorithms/math/in_parallel.h"

namespace psfm {
namespace {

/// Some clusters of the network, and all links between them; places in the network, ascending.
struct Part {
    std::vector<std::uint32_t> clusters;
    std::vector<std::uint32_t> links;
};

/// By label of its cluster. Links between clusters of different labels belong to none.
/// @param labels  of the part's clusters, consecutive from 0
std::vector<Part> divide(const ClusterNetwork& network, const Part& part,
                         std::span<const std::uint32_t> labels) {
    std::vector<Part> parts;
    std::map<std::uint32_t, std::uint32_t> label_of;
    for (std::size_t k = 0; k < part.clusters.size(); ++k) {
        if (labels[k] >= parts.size()) parts.resize(labels[k] + 1);
        parts[labels[k]].clusters.push_back(part.clusters[k]);
        label_of[part.clusters[k]] = labels[k];
    }
    for (const std::uint32_t link : part.links) {
        const std::uint32_t label = label_of.at(network.links[link].a);
        if (label == label_of.at(network.links[link].b)) parts[label].links.push_back(link);
    }
    return parts;
}

Part whole(const ClusterNetwork& network) {
    Part all;
    for (std::uint32_t c = 0; c < network.clusters.size(); ++c) all.clusters.push_back(c);
    for (std::uint32_t l = 0; l < network.links.size(); ++l) all.links.push_back(l);
    return all;
}

/// The place of a cluster among a part's.
std::uint32_t place_in(const Part& part, std::uint32_t cluster) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(part.clusters, cluster) -
                                      part.clusters.begin());
}

std::vector<LinkedModels> links_of(const ClusterNetwork& network, const Part& part) {
    std::vector<LinkedModels> links;
    for (const std::uint32_t l : part.links) {
        const ClusterLink& link = network.links[l];
        links.push_back({place_in(part, link.a), place_in(part, link.b), link.edges});
    }
    return links;
}

/// The pose graph of a part: its accepted constraints.
struct PartGraph {
    std::vector<std::size_t> sizes;  ///< images of each cluster
    std::vector<PoseGraphEdge> edges;
    std::vector<std::uint32_t> link_of_edge;  ///< place in Part::links
};

PartGraph graph_of(const ClusterNetwork& network, const Part& part) {
    PartGraph graph;
    for (const std::uint32_t c : part.clusters)
        graph.sizes.push_back(network.clusters[c]->model->images.size());
    for (std::uint32_t l = 0; l < part.links.size(); ++l) {
        const ClusterLink& link = network.links[part.links[l]];
        const ClusterConstraint& constraint = *link.constraint;
        if (!constraint.accepted()) continue;
        graph.edges.push_back({place_in(part, link.a), place_in(part, link.b), constraint.b_from_a,
                               constraint.anchor_in_a, constraint.extent_in_a,
                               static_cast<double>(constraint.inliers)});
        graph.link_of_edge.push_back(l);
    }
    return graph;
}

std::vector<std::uint64_t> basis_of(const ClusterNetwork& network, const Part& part) {
    std::vector<std::uint64_t> basis{part.clusters.size()};
    for (const std::uint32_t c : part.clusters) {
        basis.push_back(index_of(network.clusters[c]->id));
        basis.push_back(network.clusters[c]->revision);
    }
    for (const std::uint32_t l : part.links) {
        const ClusterPairEdges& edges = *network.links[l].edges;
        basis.push_back(std::uint64_t{index_of(edges.a)} << 32U | index_of(edges.b));
        basis.push_back(edges.matched.size());
        basis.push_back(edges.hash);
        basis.push_back(edges.matched_hash);
    }
    return basis;
}

/// A part's models where these poses have them.
std::vector<PlacedModel> placed_models(const ClusterNetwork& network, const Part& part,
                                       const ClusterPoses& poses) {
    std::vector<PlacedModel> models;
    for (std::size_t k = 0; k < part.clusters.size(); ++k) {
        const MergeCluster& cluster = *network.clusters[part.clusters[k]];
        models.push_back({cluster.id, cluster.model.get(), network.cameras[part.clusters[k]],
                          poses.component_from_cluster[k]});
    }
    return models;
}

/// Groups of a connected part's clusters that do not contradict each other, by cluster; nothing if
/// all are one.
std::optional<std::vector<std::uint32_t>> groups_without(
    std::span<const std::pair<std::uint32_t, std::uint32_t>> contradictions,
    const PartGraph& graph) {
    /// Guard: no constraint outweighs a contradiction.
    constexpr double kNever = -1e12;
    if (contradictions.empty()) return std::nullopt;
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> weights;
    for (const PoseGraphEdge& edge : graph.edges) weights[{edge.a, edge.b}] = edge.weight;
    for (const auto& ends : contradictions) weights[ends] = kNever;
    std::vector<SignedEdge> edges;
    edges.reserve(weights.size());
    for (const auto& [ends, weight] : weights) edges.push_back({ends.first, ends.second, weight});
    auto groups = contract_signed_graph(graph.sizes.size(), edges);
    if (*std::ranges::max_element(groups) == 0) return std::nullopt;
    return groups;
}

bool has_basis(const SolvedPartPtr& part) {
    return !part->basis.empty();
}

/// Poses of a part from those of what it was divided into.
ClusterPoses put_together(const Part& part, std::span<const Part> divided,
                          std::span<const SolvedPartPtr> solved) {
    ClusterPoses all;
    all.component_from_cluster.resize(part.clusters.size());
    all.component.resize(part.clusters.size());
    all.used.assign(part.links.size(), false);
    for (std::size_t p = 0; p < divided.size(); ++p) {
        const ClusterPoses& poses = solved[p]->poses;
        for (std::size_t k = 0; k < divided[p].clusters.size(); ++k) {
            const std::size_t place = place_in(part, divided[p].clusters[k]);
            all.component_from_cluster[place] = poses.component_from_cluster[k];
            all.component[place] = all.component_count + poses.component[k];
        }
        for (std::size_t l = 0; l < divided[p].links.size(); ++l) {
            const auto link = std::ranges::lower_bound(part.links, divided[p].links[l]);
            all.used[static_cast<std::size_t>(link - part.links.begin())] = poses.used[l];
        }
        all.component_count += poses.component_count;
    }
    std::map<std::uint32_t, std::uint32_t> number;
    for (std::uint32_t& component : all.component) {
        const auto next = static_cast<std::uint32_t>(number.size());
        component = number.try_emplace(component, next).first->second;
    }
    return all;
}

class PartSolver {
  public:
    PartSolver(const ClusterNetwork& network, const KnownPoses& known, const MergeOptions& options)
        : network_(network), options_(options), judgements_before_(*known.judgements) {
        for (const SolvedPartPtr& part : known.parts) learn(part);
    }

    /// Side by side. @param parts  each connected by constraints
    Result<std::vector<SolvedPartPtr>> solve_all(const std::vector<Part>& parts) {
        std::vector<std::optional<Result<SolvedPartPtr>>> solved(parts.size());
        in_parallel(parts.size(), [&](std::size_t p) { solved[p] = solve(parts[p]); });
        std::vector<SolvedPartPtr> all;
        for (const auto& part : solved) {
            if (!part->ok()) return part->error();
            all.push_back(**part);
        }
        return all;
    }

    std::uint32_t solved() const { return solved_; }

    /// Those that were asked for, and what is known of the other clusters.
    std::shared_ptr<const PairJudgements> judgements() {
        std::map<ClusterId, const ModelCameras*> cameras;
        for (std::size_t c = 0; c < network_.clusters.size(); ++c)
            cameras[network_.clusters[c]->id] = network_.cameras[c].get();
        const auto is_current = [&](ClusterId id, const ModelCamerasPtr& judged) {
            const auto found = cameras.find(id);
            return found != cameras.end() && found->second == judged.get();
        };
        PairJudgements all = judgements_;
        std::ranges::stable_sort(all, {}, clusters_of);
        const auto asked = static_cast<std::ptrdiff_t>(all.size());
        for (const PairJudgement& before : judgements_before_) {
            const bool is_asked = std::ranges::binary_search(all.begin(), all.begin() + asked,
                                                             clusters_of(before), {}, clusters_of);
            if (!is_asked && is_current(before.a, before.cameras_a) &&
                is_current(before.b, before.cameras_b))
                all.push_back(before);
        }
        std::inplace_merge(
            all.begin(), all.begin() + asked, all.end(),
            [&](const auto& x, const auto& y) { return clusters_of(x) < clusters_of(y); });
        return std::make_shared<const PairJudgements>(std::move(all));
    }

  private:
    void learn(const SolvedPartPtr& part) {
        if (!known_.emplace(part->basis, part).second) return;
        for (const SolvedPartPtr& group : part->groups) learn(group);
    }

    Result<SolvedPartPtr> solve(const Part& part) {
        auto solved = std::make_shared<SolvedPart>();
        if (part.clusters.size() == 1) {
            solved->poses = {{Sim3{}}, {0}, 1, {}};
            return SolvedPartPtr(solved);
        }
        solved->basis = basis_of(network_, part);
        if (const auto known = known_.find(solved->basis); known != known_.end())
            return known->second;
        ++solved_;
        const PartGraph graph = graph_of(network_, part);
        const std::vector<LinkedModels> links = links_of(network_, part);
        const auto contradicting = [&](const ClusterPoses& poses) {
            Contradictions found = find_contradictions(placed_models(network_, part, poses), links,
                                                       judgements_before_, options_.constraint);
            remember(std::move(found.judgements));
            return groups_without(found.pairs, graph);
        };
        // Most folds are seen without solving anything: one wrong constraint of the tree is enough.
        if (const auto groups = contradicting(poses_along_tree(graph.edges, graph.sizes)))
            return solve_groups(part, *groups, solved);
        auto poses = solve_cluster_poses(graph.edges, graph.sizes, options_.pose_graph);
        if (!poses.ok()) return poses.error();
        if (const auto groups = contradicting(*poses)) return solve_groups(part, *groups, solved);
        std::vector<bool> used(part.links.size(), false);
        for (std::size_t e = 0; e < poses->used.size(); ++e)
            used[graph.link_of_edge[e]] = poses->used[e];
        solved->poses = *std::move(poses);
        solved->poses.used = std::move(used);
        return SolvedPartPtr(solved);
    }

    Result<SolvedPartPtr> solve_groups(const Part& part, std::span<const std::uint32_t> group_of,
                                       const std::shared_ptr<SolvedPart>& solved) {
        const std::vector<Part> divided = divide(network_, part, group_of);
        const auto groups = solve_all(divided);
        if (!groups.ok()) return groups.error();
        solved->poses = put_together(part, divided, *groups);
        std::ranges::copy_if(*groups, std::back_inserter(solved->groups), has_basis);
        return SolvedPartPtr(solved);
    }

    void remember(PairJudgements judgements) {
        const std::lock_guard lock(judgements_mutex_);
        std::ranges::move(judgements, std::back_inserter(judgements_));
    }

    const ClusterNetwork& network_;
    const MergeOptions& options_;
    const PairJudgements& judgements_before_;
    std::mutex judgements_mutex_;
    PairJudgements judgements_;  // that parts were solved with
    std::map<std::vector<std::uint64_t>, SolvedPartPtr> known_;
    std::atomic<std::uint32_t> solved_ = 0;
};

}  // namespace

Result<ConsistentPoses> consistent_poses(const ClusterNetwork& network, const KnownPoses& known,
                                         const MergeOptions& options) {
    const Part all = whole(network);
    const PartGraph graph = graph_of(network, all);
    const std::vector<Part> connected =
        divide(network, all, poses_along_tree(graph.edges, graph.sizes).component);
    PartSolver solver(network, known, options);
    const auto solved = solver.solve_all(connected);
    if (!solved.ok()) return solved.error();
    ConsistentPoses result{put_together(all, connected, *solved), {}, solver.solved()};
    std::ranges::copy_if(*solved, std::back_inserter(result.known.parts), has_basis);
    result.known.judgements = solver.judgements();
    return result;
}

}  // namespace psfm
