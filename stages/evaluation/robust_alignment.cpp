// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/evaluation/robust_alignment.h"

#include <array>
#include <numeric>
#include <random>

#include "stages/evaluation/fit_similarity.h"

namespace psfm {
namespace {

using Points = std::span<const Eigen::Vector3d>;
using Indices = std::vector<std::uint32_t>;

struct Consensus {
    Indices inliers;
    double cost = 0.0;  ///< sum of squared distances of the inliers

    bool better_than(const Consensus& other) const {
        if (inliers.size() != other.inliers.size()) return inliers.size() > other.inliers.size();
        return cost < other.cost;
    }
};

Consensus score(const Sim3& target_from_source, Points source, Points target, double threshold) {
    Consensus result;
    for (std::uint32_t i = 0; i < source.size(); ++i) {
        const double distance = (target[i] - target_from_source * source[i]).squaredNorm();
        if (distance > threshold * threshold) continue;
        result.inliers.push_back(i);
        result.cost += distance;
    }
    return result;
}

Result<SimilarityFit> fit_subset(Points source, Points target,
                                 std::span<const std::uint32_t> subset) {
    std::vector<Eigen::Vector3d> from;
    std::vector<Eigen::Vector3d> to;
    from.reserve(subset.size());
    to.reserve(subset.size());
    for (const std::uint32_t i : subset) {
        from.push_back(source[i]);
        to.push_back(target[i]);
    }
    return fit_similarity(from, to);
}

/// Refits to what is near, with a threshold that shrinks to the wanted one, then while that gains.
Consensus optimize_locally(const Sim3& start, Points source, Points target, double threshold) {
    Consensus best = score(start, source, target, threshold);
    Sim3 current = start;
    constexpr std::array<double, 3> kWidening{3.0, 2.0, 1.0};  // Guard: steps of the search; which
    // alignment is the best one is decided by the threshold alone
    constexpr int kMaxRefits = 20;  // Guard: ends what gains in the last digits
    for (int refit = 0; refit < kMaxRefits; ++refit) {
        const bool widened = refit < static_cast<int>(kWidening.size());
        const double width = widened ? kWidening.at(static_cast<std::size_t>(refit)) : 1.0;
        const Consensus near = score(current, source, target, width * threshold);
        if (near.inliers.size() < 3) break;
        const auto fit = fit_subset(source, target, near.inliers);
        if (!fit.ok()) break;  // Expected: of images in one place nothing better can be had
        current = fit->target_from_source;
        Consensus next = score(current, source, target, threshold);
        const bool gained = next.better_than(best);
        if (gained) best = std::move(next);
        if (!gained && !widened) break;
    }
    return best;
}

/// Calls try_triple with every triple of `count` points, or with a seeded sample of them.
template <typename TryTriple>
void for_each_triple(std::uint32_t count, const RobustAlignmentOptions& options,
                     TryTriple try_triple) {
    const std::uint64_t n = count;
    // Guard: n (n-1) (n-2) overflows for large n; so many have 166 million triples.
    constexpr std::uint64_t kMostToMultiply = 1000;
    const bool exhaustive =
        n <= kMostToMultiply && n * (n - 1) * (n - 2) / 6 <= options.max_triples;
    if (exhaustive) {
        for (std::uint32_t a = 0; a < count; ++a) {
            for (std::uint32_t b = a + 1; b < count; ++b) {
                for (std::uint32_t c = b + 1; c < count; ++c) try_triple(a, b, c);
            }
        }
        return;
    }
    std::mt19937_64 random(options.seed);
    // Not std::uniform_int_distribution, whose results differ between standard libraries.
    const auto draw = [&] { return static_cast<std::uint32_t>(random() % n); };
    for (std::uint32_t sample = 0; sample < options.max_triples;) {
        const std::uint32_t a = draw();
        const std::uint32_t b = draw();
        const std::uint32_t c = draw();
        if (a == b || b == c || a == c) continue;
        try_triple(a, b, c);
        ++sample;
    }
}

}  // namespace

Result<void> validate(const RobustAlignmentOptions& options) {
    if (options.max_triples == 0) {
        return Error{ErrorCode::kInvalidArgument, "max_triples is 0: at least one has to be tried"};
    }
    return {};
}

Result<RobustAlignment> align_robustly(Points source, Points target, double inlier_threshold,
                                       const RobustAlignmentOptions& options) {
    if (const auto valid = validate(options); !valid.ok()) return valid.error();
    if (!(inlier_threshold > 0.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "the inlier threshold of an alignment is not positive"};
    }
    if (source.size() != target.size() || source.size() < 3) {
        return Error{ErrorCode::kTooFewMatches, "an alignment needs three points on each side"};
    }
    const auto count = static_cast<std::uint32_t>(source.size());
    Indices all(count);
    std::iota(all.begin(), all.end(), 0U);
    const auto fit_all = fit_subset(source, target, all);
    if (!fit_all.ok()) return fit_all.error();

    // The fit of all points is where a good model is done at once, and what no triple may fall
    // behind.
    Consensus best =
        optimize_locally(fit_all->target_from_source, source, target, inlier_threshold);
    if (best.inliers.size() < count) {
        Consensus best_triple;
        for_each_triple(count, options, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            const auto fit = fit_subset(source, target, std::array{a, b, c});
            if (!fit.ok()) return;  // Expected: three images on a line
            const Consensus found =
                score(fit->target_from_source, source, target, inlier_threshold);
            if (!found.better_than(best_triple)) return;
            best_triple = found;
            Consensus optimized =
                optimize_locally(fit->target_from_source, source, target, inlier_threshold);
            if (optimized.better_than(best)) best = std::move(optimized);
        });
    }

    RobustAlignment result;
    result.consensus = best.inliers.size() >= 3;
    result.inliers = result.consensus ? std::move(best.inliers) : std::move(all);
    auto final_fit = fit_subset(source, target, result.inliers);
    if (!final_fit.ok()) {  // three inliers that coincide: no consensus worth the name
        result.consensus = false;
        result.inliers.resize(count);
        std::iota(result.inliers.begin(), result.inliers.end(), 0U);
        final_fit = fit_all;
    }
    result.target_from_source = final_fit->target_from_source;
    result.collinear = final_fit->collinear;
    return result;
}

}  // namespace psfm
