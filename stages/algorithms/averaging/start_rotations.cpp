// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/start_rotations.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "stages/algorithms/math/angles.h"

namespace psfm {
namespace {

constexpr auto kUnseen = static_cast<std::uint32_t>(-1);  // Format: says that there is none

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
        const Eigen::Quaterniond large_from_small = consensus(votes(small, large), max_rad);
        for (const std::uint32_t node : nodes_[small]) {
            node_from_part_[node] =
                (node_from_part_[node] * large_from_small.conjugate()).normalized();
            part_of_[node] = large;
        }
        append(nodes_[large], nodes_[small]);
        append(touching_[large], touching_[small]);
    }

    const std::vector<Eigen::Quaterniond>& node_from_part() const { return node_from_part_; }
    std::uint32_t part_of(std::uint32_t node) const { return part_of_[node]; }

  private:
    struct Vote {
        Eigen::Quaterniond large_from_small;
        double weight = 0.0;
    };

    /// What each edge between two parts says, strongest first.
    std::vector<Vote> votes(std::uint32_t small, std::uint32_t large) {
        // Edges within the part are of no use any more.
        std::vector<std::uint32_t> between;
        std::erase_if(touching_[small], [&](std::uint32_t e) {
            const std::uint32_t a = part_of_[edges_[e].i];
            const std::uint32_t b = part_of_[edges_[e].j];
            if (a == large || b == large) between.push_back(e);
            return a == b;
        });
        std::ranges::sort(between, {}, [&](std::uint32_t e) { return rank_[e]; });
        std::vector<Vote> result;
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

    /// The mean of the votes that agree with the one that most weight agrees with.
    static Eigen::Quaterniond consensus(const std::vector<Vote>& votes, double max_rad) {
        // Guard: time grows with its product with the votes.
        constexpr std::size_t kCandidates = 64;
        const auto agrees = [&](const Vote& vote, const Eigen::Quaterniond& with) {
            return vote.large_from_small.angularDistance(with) <= max_rad;
        };
        Eigen::Quaterniond best = votes.front().large_from_small;
        double best_weight = 0.0;
        for (std::size_t c = 0; c < std::min(votes.size(), kCandidates); ++c) {
            double weight = 0.0;
            for (const Vote& vote : votes) {
                if (agrees(vote, votes[c].large_from_small)) weight += vote.weight;
            }
            if (weight <= best_weight) continue;
            best_weight = weight;
            best = votes[c].large_from_small;
        }
        Eigen::Vector4d sum = Eigen::Vector4d::Zero();
        for (const Vote& vote : votes) {
            if (!agrees(vote, best)) continue;
            const double sign = vote.large_from_small.dot(best) < 0.0 ? -1.0 : 1.0;
            sum += sign * vote.weight * vote.large_from_small.coeffs();
        }
        return Eigen::Quaterniond(sum).normalized();
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
    std::vector<Eigen::Quaterniond> node_from_part_;
};

}  // namespace

StartRotations rotations_of_forest(std::span<const RelativeRotation> edges,
                                   std::span<const std::uint32_t> forest,
                                   std::uint32_t node_count) {
    StartRotations start;
    start.node_from_reference.assign(node_count, Eigen::Quaterniond::Identity());
    start.component.assign(node_count, kUnseen);
    std::vector<std::vector<std::uint32_t>> at(node_count);
    for (const std::uint32_t e : forest) {
        at[edges[e].i].push_back(e);
        at[edges[e].j].push_back(e);
    }
    for (std::uint32_t root = 0; root < node_count; ++root) {
        if (start.component[root] != kUnseen) continue;
        start.component[root] = start.component_count;
        std::vector<std::uint32_t> open{root};
        while (!open.empty()) {
            const std::uint32_t node = open.back();
            open.pop_back();
            for (const std::uint32_t e : at[node]) {
                const bool forward = edges[e].i == node;
                const std::uint32_t next = forward ? edges[e].j : edges[e].i;
                if (start.component[next] != kUnseen) continue;
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
                                      std::uint32_t node_count, double max_deg, double vote_power) {
    std::vector<std::uint32_t> rank(edges.size());
    for (std::uint32_t place = 0; place < rank.size(); ++place) rank[heaviest_first[place]] = place;
    JoinedParts parts(edges, rank, node_count, vote_power);
    for (const std::uint32_t e : heaviest_first) {
        if (!parts.are_joined(edges[e].i, edges[e].j))
            parts.join(edges[e].i, edges[e].j, radians_from_degrees(max_deg));
    }
    StartRotations start;
    std::vector<std::uint32_t> reference_of_part(node_count, kUnseen);
    for (std::uint32_t node = 0; node < node_count; ++node) {
        std::uint32_t& reference = reference_of_part[parts.part_of(node)];
        if (reference == kUnseen) {
            reference = node;
            start.component.push_back(start.component_count++);
        } else {
            start.component.push_back(start.component[reference]);
        }
        start.node_from_reference.push_back(
            (parts.node_from_part()[node] * parts.node_from_part()[reference].conjugate())
                .normalized());
    }
    return start;
}

}  // namespace psfm
