// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/start_rotations.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "stages/algorithms/averaging/rotation_votes.h"
#include "stages/algorithms/averaging/turn_parts.h"
#include "stages/algorithms/math/angles.h"

namespace psfm {
namespace {

constexpr auto kNoNode = static_cast<std::uint32_t>(-1);  // Format: says that there is none
constexpr std::size_t kLargestRatio = 8;  // Guard: the nodes of all parts together grow with it

/// Parts of the graph that have been joined, each in a reference frame of its own.
class JoinedParts {
  public:
    JoinedParts(std::span<const RelativeRotation> edges, std::span<const std::uint32_t> rank,
                std::uint32_t node_count, double vote_power)
        : edges_(edges),
          rank_(rank),
          vote_power_(vote_power),
          part_of_(node_count),
          nodes_(node_count),
          touching_(node_count),
          node_from_part_(node_count, Eigen::Quaterniond::Identity()) {
        std::iota(part_of_.begin(), part_of_.end(), 0U);
        for (std::uint32_t node = 0; node < node_count; ++node) nodes_[node] = {node};
        for (std::uint32_t e = 0; e < edges.size(); ++e) {
            touching_[edges[e].i].push_back(e);
            touching_[edges[e].j].push_back(e);
        }
    }

    bool are_joined(std::uint32_t i, std::uint32_t j) const { return part_of_[i] == part_of_[j]; }

    /// REQUIRES: not joined, and an edge between their parts
    void join(std::uint32_t i, std::uint32_t j, double max_rad) {
        std::uint32_t small = part_of_[i];
        std::uint32_t large = part_of_[j];
        if (touching_[small].size() > touching_[large].size()) std::swap(small, large);
        const Eigen::Quaterniond large_from_small =
            consensus_of(votes(small, large), max_rad, VoteCount::kAll);
        for (const std::uint32_t node : nodes_[small]) {
            node_from_part_[node] =
                (node_from_part_[node] * large_from_small.conjugate()).normalized();
            part_of_[node] = large;
        }
        joined_.push_back(nodes_[small]);
        if (nodes_[large].size() <= kLargestRatio * nodes_[small].size())
            joined_.push_back(nodes_[large]);
        append(nodes_[large], nodes_[small]);
        append(touching_[large], touching_[small]);
    }

    const std::vector<Eigen::Quaterniond>& node_from_part() const { return node_from_part_; }
    std::uint32_t part_of(std::uint32_t node) const { return part_of_[node]; }
    /// Of each two that were joined, in this order, the smaller one, and the larger one where it is
    /// not much larger.
    const std::vector<std::vector<std::uint32_t>>& joined() const { return joined_; }

  private:
    /// What each edge between two parts says, strongest first.
    std::vector<RotationVote> votes(std::uint32_t small, std::uint32_t large) {
        // Edges within the part are of no use any more.
        std::vector<std::uint32_t> between;
        std::erase_if(touching_[small], [&](std::uint32_t e) {
            const std::uint32_t a = part_of_[edges_[e].i];
            const std::uint32_t b = part_of_[edges_[e].j];
            if (a == large || b == large) between.push_back(e);
            return a == b;
        });
        std::ranges::sort(between, {}, [&](std::uint32_t e) { return rank_[e]; });
        std::vector<RotationVote> result;
        result.reserve(between.size());
        for (const std::uint32_t e : between) {
            const RelativeRotation& edge = edges_[e];
            const Eigen::Quaterniond j_from_i = edge.j_from_i.normalized();
            const Eigen::Quaterniond part_of_j_from_part_of_i =
                node_from_part_[edge.j].conjugate() * j_from_i * node_from_part_[edge.i];
            result.push_back({part_of_[edge.i] == small ? part_of_j_from_part_of_i
                                                        : part_of_j_from_part_of_i.conjugate(),
                              std::pow(edge.weight, vote_power_)});
        }
        return result;
    }

    static void append(std::vector<std::uint32_t>& to, std::vector<std::uint32_t>& from) {
        to.insert(to.end(), from.begin(), from.end());
        from = {};
    }

    std::span<const RelativeRotation> edges_;
    std::span<const std::uint32_t> rank_;  ///< by edge: 0 for the strongest
    double vote_power_;
    std::vector<std::uint32_t> part_of_;
    std::vector<std::vector<std::uint32_t>> nodes_;     ///< by part
    std::vector<std::vector<std::uint32_t>> touching_;  ///< by part: edges with an end in it
    std::vector<std::vector<std::uint32_t>> joined_;
    std::vector<Eigen::Quaterniond> node_from_part_;
};

/// Each node by itself, then the parts.
std::vector<std::vector<std::uint32_t>> nodes_and(
    const std::vector<std::vector<std::uint32_t>>& parts, std::uint32_t node_count) {
    std::vector<std::vector<std::uint32_t>> all;
    all.reserve(node_count + parts.size());
    for (std::uint32_t node = 0; node < node_count; ++node) all.push_back({node});
    std::ranges::copy_if(parts, std::back_inserter(all),
                         [](const auto& part) { return part.size() > 1; });
    return all;
}

}  // namespace

StartRotations rotations_of_forest(std::span<const RelativeRotation> edges,
                                   std::span<const std::uint32_t> forest,
                                   std::uint32_t node_count) {
    StartRotations start;
    start.node_from_reference.assign(node_count, Eigen::Quaterniond::Identity());
    start.component.assign(node_count, kNoNode);
    std::vector<std::vector<std::uint32_t>> at(node_count);
    for (const std::uint32_t e : forest) {
        at[edges[e].i].push_back(e);
        at[edges[e].j].push_back(e);
    }
    for (std::uint32_t root = 0; root < node_count; ++root) {
        if (start.component[root] != kNoNode) continue;
        start.component[root] = start.component_count;
        std::vector<std::uint32_t> open{root};
        while (!open.empty()) {
            const std::uint32_t node = open.back();
            open.pop_back();
            for (const std::uint32_t e : at[node]) {
                const bool forward = edges[e].i == node;
                const std::uint32_t next = forward ? edges[e].j : edges[e].i;
                if (start.component[next] != kNoNode) continue;
                start.component[next] = start.component_count;
                const Eigen::Quaterniond next_from_node =
                    forward ? edges[e].j_from_i.normalized()
                            : edges[e].j_from_i.normalized().conjugate();
                start.node_from_reference[next] =
                    (next_from_node * start.node_from_reference[node]).normalized();
                open.push_back(next);
            }
        }
        ++start.component_count;
    }
    return start;
}

StartRotations rotations_by_consensus(std::span<const RelativeRotation> edges,
                                      std::span<const std::uint32_t> heaviest_first,
                                      std::uint32_t node_count,
                                      const RotationAveragingOptions& options) {
    std::vector<std::uint32_t> rank(edges.size());
    for (std::uint32_t place = 0; place < rank.size(); ++place) rank[heaviest_first[place]] = place;
    JoinedParts parts(edges, rank, node_count, options.vote_power);
    for (const std::uint32_t e : heaviest_first) {
        if (!parts.are_joined(edges[e].i, edges[e].j))
            parts.join(edges[e].i, edges[e].j, radians_from_degrees(options.consensus_deg));
    }
    std::vector<Eigen::Quaterniond> node_from_part = parts.node_from_part();
    turn_parts(edges, rank, nodes_and(parts.joined(), node_count), options, node_from_part);
    StartRotations start;
    std::vector<std::uint32_t> reference_of_part(node_count, kNoNode);
    for (std::uint32_t node = 0; node < node_count; ++node) {
        std::uint32_t& reference = reference_of_part[parts.part_of(node)];
        if (reference == kNoNode) {
            reference = node;
            start.component.push_back(start.component_count++);
        } else {
            start.component.push_back(start.component[reference]);
        }
        start.node_from_reference.push_back(
            (node_from_part[node] * node_from_part[reference].conjugate()).normalized());
    }
    return start;
}

}  // namespace psfm
