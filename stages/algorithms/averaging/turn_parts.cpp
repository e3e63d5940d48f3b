// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/turn_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stages/algorithms/averaging/rotation_votes.h"
#include "stages/algorithms/math/angles.h"

namespace psfm {
namespace {

/// Rotations of nodes that are turned part by part.
class TurningParts {
  public:
    TurningParts(std::span<const RelativeRotation> edges, std::span<const std::uint32_t> rank,
                 const RotationAveragingOptions& options,
                 std::vector<Eigen::Quaterniond>& node_from_reference)
        : edges_(edges),
          rank_(rank),
          options_(options),
          node_from_reference_(node_from_reference),
          touching_(node_from_reference.size()),
          is_inside_(node_from_reference.size(), 0) {
        for (std::uint32_t e = 0; e < edges.size(); ++e) {
            touching_[edges[e].i].push_back(e);
            touching_[edges[e].j].push_back(e);
        }
    }

    /// @return whether the part was turned
    bool turn(std::span<const std::uint32_t> part) {
        const std::vector<RotationVote> votes = votes_around(part);
        if (votes.empty()) return false;
        const double max_rad = radians_from_degrees(options_.consensus_deg);
        const auto speaks_for = [&](const Eigen::Quaterniond& rotation, VoteCount count) {
            return weight_for(rotation, votes, max_rad, count);
        };
        const Eigen::Quaterniond as_it_is = Eigen::Quaterniond::Identity();
        const double needed =
            options_.turn_again_factor * speaks_for(as_it_is, VoteCount::kBeyondStrongest);
        const double all = weight_for(as_it_is, votes, std::numbers::pi, VoteCount::kAll);
        if (all <= needed) return false;
        const Eigen::Quaterniond turned = consensus_of(votes, max_rad, VoteCount::kBeyondStrongest);
        if (speaks_for(turned, VoteCount::kBeyondStrongest) <= needed ||
            2.0 * speaks_for(turned, VoteCount::kAll) < speaks_for(as_it_is, VoteCount::kAll))
            return false;
        for (const std::uint32_t node : part)
            node_from_reference_[node] = (node_from_reference_[node] * turned).normalized();
        return true;
    }

  private:
    /// How each edge between a part and all else would turn the part, strongest first.
    std::vector<RotationVote> votes_around(std::span<const std::uint32_t> part) {
        for (const std::uint32_t node : part) is_inside_[node] = 1;
        std::vector<std::uint32_t> across;
        for (const std::uint32_t node : part) {
            for (const std::uint32_t e : touching_[node]) {
                if (is_inside_[edges_[e].i] != is_inside_[edges_[e].j]) across.push_back(e);
            }
        }
        std::ranges::sort(across, {}, [&](std::uint32_t e) { return rank_[e]; });
        std::vector<RotationVote> votes;
        votes.reserve(across.size());
        for (const std::uint32_t e : across) {
            const RelativeRotation& edge = edges_[e];
            const Eigen::Quaterniond turn_of_j = node_from_reference_[edge.j].conjugate() *
                                                 edge.j_from_i.normalized() *
                                                 node_from_reference_[edge.i];
            votes.push_back({is_inside_[edge.j] != 0 ? turn_of_j : turn_of_j.conjugate(),
                             std::pow(edge.weight, options_.vote_power)});
        }
        for (const std::uint32_t node : part) is_inside_[node] = 0;
        return votes;
    }

    std::span<const RelativeRotation> edges_;
    std::span<const std::uint32_t> rank_;
    const RotationAveragingOptions& options_;
    std::vector<Eigen::Quaterniond>& node_from_reference_;
    std::vector<std::vector<std::uint32_t>> touching_;  ///< by node: edges
    std::vector<char> is_inside_;                       ///< by node, while a part is asked
};

}  // namespace

void turn_parts(std::span<const RelativeRotation> edges, std::span<const std::uint32_t> rank,
                const std::vector<std::vector<std::uint32_t>>& parts,
                const RotationAveragingOptions& options,
                std::vector<Eigen::Quaterniond>& node_from_reference) {
    if (options.turn_again_factor == 0.0) return;
    TurningParts turning(edges, rank, options, node_from_reference);
    constexpr int kRounds = 3;  // Guard: parts may turn one another
    for (int round = 0; round < kRounds; ++round) {
        bool any = false;
        for (const auto& part : parts) any = turning.turn(part) || any;
        if (!any) return;
    }
}

}  // namespace psfm
