// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/view_graphs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

/// Collects edges in any order and direction; the heavier one of two for the same pair stays.
class EdgeSet {
  public:
    void add(std::uint32_t a, std::uint32_t b, double weight) {
        const double whole = std::round(weight);
        if (a == b || whole < 1.0) return;
        double& kept = weights_[std::minmax(a, b)];
        kept = std::max(kept, whole);
    }

    WeightedGraph graph(std::uint32_t nodes) const {
        WeightedGraph result{.nodes = nodes, .edges = {}};
        for (const auto& [pair, weight] : weights_) {
            result.edges.push_back({pair.first, pair.second, weight});
        }
        return result;
    }

  private:
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> weights_;
};

/// Many weak edges, few strong ones: uniform in the logarithm.
double random_weight(Rng& rng, double low, double high) {
    return low * std::pow(high / low, rng.uniform());
}

}  // namespace

WeightedGraph make_erdos_renyi(const ErdosRenyiOptions& options, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 20));
    EdgeSet edges;
    for (std::uint32_t b = 1; b < options.nodes; ++b) {
        for (std::uint32_t a = 0; a < b; ++a) {
            if (rng.uniform() >= options.probability) continue;
            edges.add(a, b, random_weight(rng, options.min_weight, options.max_weight));
        }
    }
    return edges.graph(options.nodes);
}

WeightedGraph make_look_alike_ring(const LookAlikeRingOptions& options, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 21));
    EdgeSet edges;
    for (std::uint32_t side = 0; side < options.folds; ++side) {
        const std::uint32_t shift = side * options.nodes / options.folds;
        const double peak = options.peak_weight * (side == 0 ? 1.0 : options.look_alike_ratio);
        for (std::uint32_t i = 0; i < options.nodes; ++i) {
            for (std::uint32_t apart = 0; apart <= options.reach; ++apart) {
                const double part = 1.0 - static_cast<double>(apart) / (options.reach + 1);
                const double weight = peak * part * part * rng.uniform(0.8, 1.2);
                edges.add(i, (i + shift + apart) % options.nodes, weight);
            }
        }
    }
    return edges.graph(options.nodes);
}

WeightedGraph make_communities(const CommunityOptions& options, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 22));
    EdgeSet edges;
    const std::uint32_t nodes = options.communities * options.nodes_each;
    for (std::uint32_t b = 1; b < nodes; ++b) {
        for (std::uint32_t a = 0; a < b; ++a) {
            const bool inner = a / options.nodes_each == b / options.nodes_each;
            if (rng.uniform() >= (inner ? options.inner_probability : options.outer_probability))
                continue;
            edges.add(
                a, b,
                (inner ? options.inner_weight : options.outer_weight) * rng.uniform(0.5, 1.5));
        }
    }
    return edges.graph(nodes);
}

WeightedGraph make_stars(const StarOptions& options, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 23));
    EdgeSet edges;
    const std::uint32_t size = options.leaves_each + 1;
    for (std::uint32_t star = 0; star < options.stars; ++star) {
        const std::uint32_t hub = star * size;
        for (std::uint32_t leaf = 1; leaf < size; ++leaf) {
            edges.add(hub, hub + leaf, random_weight(rng, options.min_weight, options.max_weight));
        }
        if (star == 0) continue;
        edges.add(hub - size, hub, random_weight(rng, options.min_weight, options.max_weight));
    }
    return edges.graph(options.stars * size);
}

WeightedGraph make_any_graph(std::uint32_t max_nodes, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 24));
    const auto number = [&](std::uint32_t low, std::uint32_t high) {
        return low + static_cast<std::uint32_t>(rng.below(high - low + 1));
    };
    WeightedGraph graph;
    switch (rng.below(4)) {
        case 0: {
            ErdosRenyiOptions options;
            options.nodes = number(1, max_nodes);
            options.probability = rng.uniform(0.02, 0.9);
            graph = make_erdos_renyi(options, rng.bits());
            break;
        }
        case 1: {
            LookAlikeRingOptions options;
            options.nodes = number(3, max_nodes);
            options.folds = number(1, 6);
            options.reach = number(1, 6);
            options.look_alike_ratio = rng.uniform(0.02, 0.9);
            graph = make_look_alike_ring(options, rng.bits());
            break;
        }
        case 2: {
            CommunityOptions options;
            options.communities = number(1, 4);
            options.nodes_each = number(1, max_nodes / options.communities);
            options.inner_probability = rng.uniform(0.4, 1.0);
            options.outer_probability = rng.uniform(0.0, 0.3);
            options.outer_weight = rng.uniform(15.0, 300.0);
            graph = make_communities(options, rng.bits());
            break;
        }
        default: {
            StarOptions options;
            options.stars = number(1, max_nodes / 3);
            options.leaves_each = number(0, max_nodes / options.stars - 1);
            graph = make_stars(options, rng.bits());
            break;
        }
    }
    if (rng.below(8) == 0) {
        for (WeightedEdge& edge : graph.edges) edge.weight = 100.0;
    }
    return reorder_nodes(graph, random_order(graph.nodes, rng.bits()));
}

WeightedGraph reorder_nodes(const WeightedGraph& graph, std::span<const std::size_t> order) {
    std::vector<std::uint32_t> place(graph.nodes);
    for (std::uint32_t i = 0; i < graph.nodes; ++i) place[order[i]] = i;
    EdgeSet edges;
    for (const WeightedEdge& edge : graph.edges)
        edges.add(place[edge.a], place[edge.b], edge.weight);
    return edges.graph(graph.nodes);
}

std::vector<std::vector<WeightedEdge>> arrivals(const WeightedGraph& graph) {
    std::vector<std::vector<WeightedEdge>> result(graph.nodes);
    for (const WeightedEdge& edge : graph.edges) result[edge.b].push_back(edge);
    return result;
}

ViewGraph make_view_graph(const WeightedGraph& graph) {
    ViewGraph result;
    for (std::uint32_t i = 0; i < graph.nodes; ++i) result.add_node();
    for (const WeightedEdge& edge : graph.edges) {
        result.add_edge(static_cast<ImageId>(edge.a), static_cast<ImageId>(edge.b), edge.weight);
    }
    return result;
}

}  // namespace psfm::synthetic
