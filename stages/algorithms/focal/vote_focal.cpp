// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/focal/vote_focal.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace psfm {
namespace {

/// Guard: steps of about 3 %: below the width of the votes of real pairs. The peak is found between
/// them.
constexpr int kSteps = 88;

/// Mathematics: full width at half maximum of a Gaussian, over its standard deviation.
constexpr double kWidthOverDeviation = 2.3548;

double votes_at(std::span<const FocalPair> pairs, double log_focal, double width) {
    const Eigen::VectorXd log_focals = Eigen::VectorXd::Constant(1, log_focal);
    double votes = 0.0;
    for (const FocalPair& pair : pairs) {
        const double relative = essential_defect(pair, log_focals) / width;
        votes += pair.weight * std::exp(-0.5 * relative * relative);
    }
    return votes;
}

}  // namespace

FocalVote vote_focal(std::span<const FocalPair> pairs, const FocalCalibrationOptions& options) {
    const double low = std::log(options.min_relative_focal);
    const double step = (std::log(options.max_relative_focal) - low) / kSteps;
    std::vector<double> votes(kSteps + 1);
    for (int i = 0; i <= kSteps; ++i) {
        votes[static_cast<std::size_t>(i)] = votes_at(pairs, low + step * i, options.vote_width);
    }
    const auto best = std::ranges::max_element(votes);
    const auto index = best - votes.begin();
    FocalVote vote{low + step * static_cast<double>(index), 0.0};
    if (best != votes.begin() && best + 1 != votes.end()) {
        const double bend = *(best - 1) - 2 * *best + *(best + 1);
        if (bend < 0) vote.log_focal += step * 0.5 * (*(best - 1) - *(best + 1)) / bend;
    }
    // Half the width of the peak at half its height, as the standard deviation of a Gaussian.
    const double half = 0.5 * (*best + *std::ranges::min_element(votes));
    const auto below = [&](double height) { return height < half; };
    const auto right = std::find_if(best, votes.end(), below);
    const auto left = std::find_if(std::make_reverse_iterator(best), votes.rend(), below);
    const auto width = (right - votes.begin()) - (left.base() - votes.begin());
    vote.spread = step * static_cast<double>(width) / kWidthOverDeviation;
    return vote;
}

}  // namespace psfm
