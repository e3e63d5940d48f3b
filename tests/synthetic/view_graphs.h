// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/view_graph.h"

/// View graphs of weights alone, for clustering, and orders in which their images may arrive. All
/// are deterministic for equal options and seed, thread-safe, and of O(nodes + edges) but for
/// Erdos-Renyi's O(nodes^2). Weights are whole numbers, as counts of matches are, so that sums do
/// not depend on order.
namespace psfm::synthetic {

struct WeightedEdge {
    std::uint32_t a = 0, b = 0;  ///< a < b
    double weight = 1.0;
    auto operator<=>(const WeightedEdge&) const = default;
};

/// Invariants: edges ascending, each pair at most once, weights above 0.
struct WeightedGraph {
    std::uint32_t nodes = 0;
    std::vector<WeightedEdge> edges;
    bool operator==(const WeightedGraph&) const = default;
};

struct ErdosRenyiOptions {
    std::uint32_t nodes = 20;
    double probability = 0.3;  ///< of each possible edge
    double min_weight = 15.0, max_weight = 500.0;
};
WeightedGraph make_erdos_renyi(const ErdosRenyiOptions& options, std::uint64_t seed);

/// A ring of photographs around something whose sides look alike: neighbours up to `reach` apart
/// share matches that become fewer with distance, and so, by a part, do images a whole number of
/// sides apart.
struct LookAlikeRingOptions {
    std::uint32_t nodes = 60;
    std::uint32_t folds = 6;  ///< sides that look alike; 1: no look-alikes
    std::uint32_t reach = 5;
    double peak_weight = 1000.0;     ///< of an image with itself, if it were
    double look_alike_ratio = 0.12;  ///< 172 of 1393 on temple-341 (docs/datasets.md)
};
WeightedGraph make_look_alike_ring(const LookAlikeRingOptions& options, std::uint64_t seed);

/// Groups with many strong edges inside and few weak ones between them.
struct CommunityOptions {
    std::uint32_t communities = 4;
    std::uint32_t nodes_each = 8;
    double inner_probability = 0.8, outer_probability = 0.05;
    double inner_weight = 300.0,
           outer_weight = 30.0;  ///< each edge between half and one and a half of it
};
WeightedGraph make_communities(const CommunityOptions& options, std::uint64_t seed);

/// Hubs with leaves that know only their hub; neighbouring hubs are connected to one another.
struct StarOptions {
    std::uint32_t stars = 3;
    std::uint32_t leaves_each = 6;
    double min_weight = 15.0, max_weight = 200.0;
};
WeightedGraph make_stars(const StarOptions& options, std::uint64_t seed);

/// One of the families above with random options and at most `max_nodes` nodes (one in eight with
/// weights that are all equal, for ties), its nodes renamed at random: fuel for property tests.
/// REQUIRES: max_nodes >= 4.
WeightedGraph make_any_graph(std::uint32_t max_nodes, std::uint64_t seed);

/// The same graph when its images arrive in another order: node i of the result is node order[i].
/// REQUIRES: order is a permutation of the nodes.
WeightedGraph reorder_nodes(const WeightedGraph& graph, std::span<const std::size_t> order);

/// What each arrival brings: element i holds the edges between node i and earlier nodes (b == i).
std::vector<std::vector<WeightedEdge>> arrivals(const WeightedGraph& graph);

/// Node i is ImageId i; pairs are null.
ViewGraph make_view_graph(const WeightedGraph& graph);

}  // namespace psfm::synthetic
