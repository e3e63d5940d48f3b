// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/rotation_votes.h"

#include <algorithm>
#include <cstddef>

namespace psfm {

double weight_for(const Eigen::Quaterniond& rotation, std::span<const RotationVote> votes,
                  double max_rad, VoteCount count) {
    double weight = 0.0;
    double strongest = 0.0;
    for (const RotationVote& vote : votes) {
        if (vote.rotation.angularDistance(rotation) > max_rad) continue;
        weight += vote.weight;
        strongest = std::max(strongest, vote.weight);
    }
    return count == VoteCount::kAll ? weight : weight - strongest;
}

Eigen::Quaterniond consensus_of(std::span<const RotationVote> votes, double max_rad,
                                VoteCount count) {
    // Guard: time grows with its product with the votes.
    constexpr std::size_t kCandidates = 64;
    Eigen::Quaterniond best = votes.front().rotation;
    double best_weight = 0.0;
    for (const RotationVote& candidate : votes.first(std::min(votes.size(), kCandidates))) {
        const double weight = weight_for(candidate.rotation, votes, max_rad, count);
        if (weight <= best_weight) continue;
        best_weight = weight;
        best = candidate.rotation;
    }
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (const RotationVote& vote : votes) {
        if (vote.rotation.angularDistance(best) > max_rad) continue;
        const double sign = vote.rotation.dot(best) < 0.0 ? -1.0 : 1.0;
        sum += sign * vote.weight * vote.rotation.coeffs();
    }
    return Eigen::Quaterniond(sum).normalized();
}

}  // namespace psfm
