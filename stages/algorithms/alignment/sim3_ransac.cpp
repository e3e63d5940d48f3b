// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/sim3_ransac.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "stages/algorithms/alignment/estimate_sim3.h"

namespace psfm {
namespace {

/// Guard: least squares on inliers: often enough to settle, seldom more than three times.
constexpr int kLocalSteps = 4;

/// Weight of a correspondence in least squares over positions: a shift sideways counts as it would
/// in the image.
double image_weight(const EdgeCorrespondences& edge, const PointCorrespondence& point) {
    const double depth = (edge.view_b.cam_from_cluster * point.in_b).z();
    return 1.0 / (depth * depth);
}

std::optional<Sim3> fit_inliers(std::span<const EdgeCorrespondences> edges, const Sim3& b_from_a,
                                double max_error) {
    const Sim3 a_from_b = inverse(b_from_a);
    std::vector<Eigen::Vector3d> in_a;
    std::vector<Eigen::Vector3d> in_b;
    std::vector<double> weights;
    for (const EdgeCorrespondences& edge : edges) {
        const CorrespondenceError error(edge, b_from_a, a_from_b);
        for (const PointCorrespondence& point : edge.points) {
            if (error(point) > max_error) continue;
            in_a.push_back(point.in_a);
            in_b.push_back(point.in_b);
            weights.push_back(image_weight(edge, point));
        }
    }
    auto fitted = estimate_sim3(in_a, in_b, weights);
    return fitted ? std::optional(*fitted) : std::nullopt;
}

class Search {
  public:
    Search(std::span<const EdgeCorrespondences> edges, const ClusterConstraintOptions& options)
        : edges_(edges), max_error_(options.max_error) {}

    /// @return whether this is the best so far
    bool consider(const Sim3& b_from_a) {
        const double bound = best_ ? best_->support.cost : std::numeric_limits<double>::infinity();
        const Sim3Support support = support_of(edges_, b_from_a, max_error_, bound);
        if (support.cost >= bound) return false;
        best_ = RobustSim3{b_from_a, support};
        return true;
    }

    void improve() {
        for (int step = 0; step < kLocalSteps; ++step) {
            const std::optional<Sim3> fitted = fit_inliers(edges_, best_->b_from_a, max_error_);
            if (!fitted || !consider(*fitted)) return;
        }
    }

    const std::optional<RobustSim3>& best() const { return best_; }

  private:
    std::span<const EdgeCorrespondences> edges_;
    double max_error_;
    std::optional<RobustSim3> best_;
};

/// Samples after which one without outliers was drawn with the given confidence.
double needed_samples(double inlier_ratio, double confidence) {
    const double clean = inlier_ratio * inlier_ratio * inlier_ratio;
    if (clean >= 1.0) return 1.0;
    if (clean <= 0.0) return std::numeric_limits<double>::infinity();
    return std::log1p(-confidence) / std::log1p(-clean);
}

}  // namespace

Sim3Support support_of(std::span<const EdgeCorrespondences> edges, const Sim3& b_from_a,
                       double max_error, double enough) {
    const Sim3 a_from_b = inverse(b_from_a);
    Sim3Support support;
    for (const EdgeCorrespondences& edge : edges) {
        const CorrespondenceError error(edge, b_from_a, a_from_b);
        for (const PointCorrespondence& point : edge.points) {
            const double relative = error(point) / max_error;
            if (relative <= 1.0) ++support.inliers;
            support.cost += std::min(relative * relative, 1.0);
        }
        if (support.cost >= enough) break;
    }
    return support;
}

Result<RobustSim3> estimate_sim3_ransac(std::span<const EdgeCorrespondences> edges,
                                        std::span<const Sim3> candidates,
                                        const ClusterConstraintOptions& options,
                                        std::uint64_t seed) {
    std::vector<const PointCorrespondence*> all;
    for (const EdgeCorrespondences& edge : edges) {
        for (const PointCorrespondence& point : edge.points) all.push_back(&point);
    }
    if (all.size() < 3) {
        return Error{ErrorCode::kTooFewMatches, "similarity: fewer than three common points"};
    }
    Search search(edges, options);
    for (const Sim3& candidate : candidates) search.consider(candidate);
    if (search.best()) search.improve();

    std::mt19937_64 random(seed);
    // Fewer inliers than min_inlier_ratio would be of no use, so that ratio bounds the samples from
    // the start.
    const auto enough = [&](std::uint32_t samples) {
        double ratio = options.min_inlier_ratio;
        if (search.best()) {
            ratio = std::max(ratio, static_cast<double>(search.best()->support.inliers) /
                                        static_cast<double>(all.size()));
        }
        return samples >= needed_samples(ratio, options.confidence);
    };
    for (std::uint32_t k = 0; k < options.max_ransac_iterations && !enough(k); ++k) {
        std::array<Eigen::Vector3d, 3> in_a;
        std::array<Eigen::Vector3d, 3> in_b;
        for (std::size_t s = 0; s < 3; ++s) {
            const PointCorrespondence& point = *all[random() % all.size()];
            in_a[s] = point.in_a;
            in_b[s] = point.in_b;
        }
        const auto sample = estimate_sim3(in_a, in_b);  // fails when a point was drawn twice
        // Expected: three points on a line give no similarity
        if (sample.ok() && search.consider(*sample)) search.improve();
    }
    if (!search.best()) {
        return Error{ErrorCode::kDegenerate, "similarity: the common points lie on one line"};
    }
    return *search.best();
}

}  // namespace psfm
