// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/filter_directions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/random_numbers.h"

namespace psfm {
namespace {

/// Draws axes from the kernel density estimate of the edges' directions: one of the edges, by
/// weight, and a normal deviation from it.
class AxisSampler {
  public:
    AxisSampler(std::span<const RelativeDirection> edges, double bandwidth_deg, std::uint64_t seed)
        : edges_(edges), bandwidth_(radians_from_degrees(bandwidth_deg)), random_(seed) {
        double sum = 0.0;
        for (const RelativeDirection& edge : edges) sums_.push_back(sum += edge.weight);
    }

    Eigen::Vector3d next() {
        const auto at = std::ranges::upper_bound(sums_, random_.uniform() * sums_.back());
        const auto edge = std::min(static_cast<std::size_t>(at - sums_.begin()), edges_.size() - 1);
        Eigen::Vector3d deviation;
        for (double& coordinate : deviation) coordinate = bandwidth_ * random_.normal();
        return (edges_[edge].direction + deviation).normalized();
    }

  private:
    std::span<const RelativeDirection> edges_;
    double bandwidth_;
    RandomNumbers random_;
    std::vector<double> sums_;
};

/// Edges at each node, in one array.
struct Incidence {
    std::vector<std::uint32_t> offsets;
    std::vector<std::uint32_t> edges;

    Incidence(std::span<const RelativeDirection> all, std::uint32_t node_count)
        : offsets(node_count + 1, 0), edges(2 * all.size()) {
        for (const RelativeDirection& edge : all) {
            ++offsets[edge.i + 1];
            ++offsets[edge.j + 1];
        }
        for (std::uint32_t node = 0; node < node_count; ++node) {
            offsets[node + 1] += offsets[node];
        }
        std::vector<std::uint32_t> next(offsets.begin(), offsets.end() - 1);
        for (std::uint32_t e = 0; e < all.size(); ++e) {
            edges[next[all[e].i]++] = e;
            edges[next[all[e].j]++] = e;
        }
    }
    std::span<const std::uint32_t> at(std::uint32_t node) const {
        return std::span(edges).subspan(offsets[node], offsets[node + 1] - offsets[node]);
    }
};

/// One axis: each edge an arc from the node that comes first to the one that comes later.
struct Arc {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    double length = 0.0;  ///< of the direction's projection, in [0, 1]
    double weight = 0.0;  ///< length times the edge's weight
};

/// The greedy ordering. Entries of the queue go stale when a neighbour is placed; a newer one is
/// then in the queue, too.
class GreedyOrder {
  public:
    GreedyOrder(const std::vector<Arc>& arcs, const Incidence& incidence)
        : arcs_(arcs), incidence_(incidence), nodes_(incidence.offsets.size() - 1) {
        for (const Arc& arc : arcs) {
            nodes_[arc.from].leaving += arc.weight;
            nodes_[arc.to].entering += arc.weight;
            ++nodes_[arc.to].arcs_entering;
        }
        for (std::uint32_t node = 0; node < nodes_.size(); ++node) push(node);
    }

    /// @return by node: its place
    std::vector<std::uint32_t> run() {
        std::vector<std::uint32_t> place(nodes_.size());
        std::uint32_t next = 0;
        while (!queue_.empty()) {
            const Entry entry = queue_.top();
            queue_.pop();
            Node& node = nodes_[entry.node];
            if (node.placed || entry.version != node.version) continue;
            node.placed = true;
            place[entry.node] = next++;
            for (const std::uint32_t e : incidence_.at(entry.node)) take_out(arcs_[e], entry.node);
        }
        return place;
    }

  private:
    struct Node {
        double leaving = 0.0;
        double entering = 0.0;
        std::uint32_t arcs_entering = 0;
        std::uint32_t version = 0;
        bool placed = false;
    };
    struct Entry {
        double ratio;
        std::uint32_t node;
        std::uint32_t version;
        bool operator<(const Entry& other) const {
            return std::tie(ratio, other.node) < std::tie(other.ratio, node);
        }
    };

    void push(std::uint32_t index) {
        Node& node = nodes_[index];
        const double ratio = node.arcs_entering == 0 ? std::numeric_limits<double>::infinity()
                                                     : (1.0 + node.leaving) / (1.0 + node.entering);
        queue_.push({ratio, index, ++node.version});
    }

    void take_out(const Arc& arc, std::uint32_t placed) {
        const std::uint32_t other = arc.from == placed ? arc.to : arc.from;
        if (nodes_[other].placed) return;
        if (arc.from == placed) {
            nodes_[other].entering -= arc.weight;
            --nodes_[other].arcs_entering;
        } else {
            nodes_[other].leaving -= arc.weight;
        }
        push(other);
    }

    const std::vector<Arc>& arcs_;
    const Incidence& incidence_;
    std::vector<Node> nodes_;
    std::priority_queue<Entry> queue_;
};

double mean_weight(std::span<const RelativeDirection> edges) {
    double sum = 0.0;
    for (const RelativeDirection& edge : edges) sum += edge.weight;
    return sum / static_cast<double>(edges.size());
}

}  // namespace

Result<void> validate(const DirectionFilterOptions& options) {
    if (options.axes == 0 || !(options.bandwidth_deg >= 0.0) || !(options.max_score >= 0.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "direction filter: axes must be at least 1, bandwidth_deg and max_score must "
                     "not be negative"};
    }
    return {};
}

Result<DirectionFilter> filter_directions(std::span<const RelativeDirection> edges,
                                          std::uint32_t node_count,
                                          const DirectionFilterOptions& options,
                                          std::uint64_t seed) {
    if (auto valid = validate(options); !valid.ok()) return valid.error();
    if (auto valid = check_directions(edges, node_count); !valid.ok()) return valid.error();
    DirectionFilter result;
    if (edges.empty()) return result;

    AxisSampler sampler(edges, options.bandwidth_deg, seed);
    const Incidence incidence(edges, node_count);
    const double unit = mean_weight(edges);
    result.score.assign(edges.size(), 0.0);
    std::vector<Arc> arcs(edges.size());
    for (std::uint32_t k = 0; k < options.axes; ++k) {
        const Eigen::Vector3d axis = sampler.next();
        for (std::size_t e = 0; e < edges.size(); ++e) {
            const double along = axis.dot(edges[e].direction);
            const double length = std::abs(along);
            arcs[e] = {along >= 0.0 ? edges[e].i : edges[e].j,
                       along >= 0.0 ? edges[e].j : edges[e].i, length,
                       length * edges[e].weight / unit};
        }
        const std::vector<std::uint32_t> place = GreedyOrder(arcs, incidence).run();
        for (std::size_t e = 0; e < edges.size(); ++e) {
            if (place[arcs[e].from] > place[arcs[e].to]) result.score[e] += arcs[e].length;
        }
    }
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
        result.score[e] /= static_cast<double>(options.axes);
        if (result.score[e] <= options.max_score) result.kept.push_back(e);
    }
    return result;
}

}  // namespace psfm
