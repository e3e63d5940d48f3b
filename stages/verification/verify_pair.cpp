// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/verify_pair.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>

#include "stages/algorithms/two_view/decompose_two_view.h"
#include "stages/algorithms/two_view/estimate_two_view.h"
#include "stages/verification/fit_two_view.h"
#include "stages/verification/verify_matches.h"

namespace psfm {
namespace {

/// Fewest inliers that verify a pair of this many matches.
std::size_t required_inliers(std::size_t matches, const VerifyOptions& options) {
    const double share = std::ceil(options.min_inlier_ratio * static_cast<double>(matches));
    return std::max(static_cast<std::size_t>(options.min_inliers), static_cast<std::size_t>(share));
}

/// Iterations after which a model that has so many inliers would have been found.
RobustOptions robust_options(std::size_t inliers, std::size_t matches, int sample_size,
                             const VerifyOptions& options) {
    const double ratio = static_cast<double>(inliers) / static_cast<double>(matches);
    const double clean = std::clamp(std::pow(ratio, sample_size), 1e-12, 1.0 - 1e-9);
    const double needed = std::ceil(std::log(1.0 - options.confidence) / std::log1p(-clean));
    const double iterations = std::clamp(needed, 1.0, static_cast<double>(options.max_iterations));
    return {options.max_error_px, options.confidence, static_cast<int>(iterations)};
}

std::optional<TwoViewModel> fit_general(const TwoViewProblem& problem, std::size_t required,
                                        const VerifyOptions& options, std::uint64_t seed) {
    const std::size_t count = problem.matches.size();
    if (problem.calibrated) {
        const auto essential = estimate_essential(
            problem.pixels, problem.intrinsics, robust_options(required, count, 5, options), seed);
        if (!essential) return std::nullopt;
        return fit_essential(problem, *essential, options);
    }
    const auto fundamental =
        estimate_fundamental(problem.pixels, robust_options(required, count, 7, options), seed);
    if (!fundamental) return std::nullopt;
    return fit_fundamental(problem, *fundamental, options);
}

/// Fewest inliers of a homography that explains the pair, whatever else does.
std::size_t inliers_to_explain(const std::optional<TwoViewModel>& general, std::size_t required,
                               const VerifyOptions& options) {
    if (!general) return required;
    const double share =
        std::ceil(options.homography_ratio * static_cast<double>(general->inliers.size()));
    return std::max(required, static_cast<std::size_t>(share));
}

/// Inliers that the search for such a homography expects of it: one from a clean sample of four has
/// fewer than the best. Raised: planar pairs are overlooked (with 1, 25 of 500 of the first 100
/// photographs of quad-streams; with this, none); lowered: slower (docs/verification.md). Ours.
std::size_t sought(std::size_t inliers) {
    return std::max(std::size_t{1}, 3 * inliers / 4);
}

Error too_few(std::size_t count, std::size_t required) {
    return {ErrorCode::kTooFewMatches, std::to_string(count) + " matches, and at least " +
                                           std::to_string(required) + " are needed"};
}

Error degenerate(std::size_t inliers, std::size_t matches, std::size_t required) {
    return {ErrorCode::kDegenerate, std::to_string(inliers) + " of " + std::to_string(matches) +
                                        " matches agree on a geometry, and " +
                                        std::to_string(required) + " are needed"};
}

Error on_a_line() {
    return {ErrorCode::kDegenerate,
            "the matches that agree lie on one line of an image, which fits many geometries"};
}

/// Root mean square distance [px] of points from the line that fits them best.
double spread_across(std::span<const PointPair> pixels, const Indices& indices,
                     Eigen::Vector2d PointPair::*side) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const std::uint32_t i : indices) mean += pixels[i].*side;
    mean /= static_cast<double>(indices.size());
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (const std::uint32_t i : indices) {
        const Eigen::Vector2d offset = pixels[i].*side - mean;
        scatter += offset * offset.transpose();
    }
    scatter /= static_cast<double>(indices.size());
    const double smaller_eigenvalue =
        0.5 * scatter.trace() - std::hypot(0.5 * (scatter(0, 0) - scatter(1, 1)), scatter(0, 1));
    return std::sqrt(std::max(0.0, smaller_eigenvalue));
}

/// Points on one line of an image determine no model, however well they fit one.
bool lie_on_a_line(const TwoViewProblem& problem, const TwoViewModel& model,
                   const VerifyOptions& options) {
    return spread_across(problem.pixels, model.inliers, &PointPair::x1) <= options.max_error_px ||
           spread_across(problem.pixels, model.inliers, &PointPair::x2) <= options.max_error_px;
}

TwoViewGeometry geometry_of(const TwoViewProblem& problem, const TwoViewModel& model) {
    TwoViewGeometry geometry;
    geometry.kind = model.kind;
    geometry.matrix = model.matrix;
    geometry.cam2_from_cam1 = model.cam2_from_cam1;
    geometry.inliers = feature_matches(problem, model.inliers);
    if (model.kind != TwoViewKind::kPureRotation) {
        geometry.median_angle_deg = median_triangulation_angle_deg(
            model.cam2_from_cam1, select(problem.normalized, model.inliers));
    }
    return geometry;
}

}  // namespace

Result<TwoViewGeometry> verify_matches(const MatchedViews& views, const VerifyOptions& asked,
                                       std::uint64_t seed) {
    if (const Result<void> valid = validate(asked); !valid.ok()) return valid.error();
    const VerifyOptions options = options_for(asked, views.camera1, views.camera2);
    const Result<TwoViewProblem> made = make_two_view_problem(views, options.max_error_px);
    if (!made.ok()) return made.error();
    const TwoViewProblem& problem = *made;
    const std::size_t count = problem.matches.size();
    const auto fewest = static_cast<std::size_t>(options.min_inliers);
    if (count < fewest) return too_few(count, fewest);
    const std::size_t required = required_inliers(count, options);

    std::optional<TwoViewModel> model = fit_general(problem, required, options, seed);
    const std::size_t explaining = inliers_to_explain(model, required, options);
    const auto homography = estimate_homography(
        problem.pixels, robust_options(sought(explaining), count, 4, options), seed);
    if (homography && homography->inliers.size() >= explaining)
        model = fit_homography(problem, *homography, model, options);
    if (!model) return degenerate(0, count, required);
    TwoViewGeometry geometry = geometry_of(problem, *model);
    if (geometry.inliers.size() < required)
        return degenerate(geometry.inliers.size(), count, required);
    if (lie_on_a_line(problem, *model, options)) return on_a_line();
    return geometry;
}

Result<TwoViewGeometry> with_intrinsics(const TwoViewGeometry& geometry, const MatchedViews& views,
                                        const VerifyOptions& asked) {
    if (const Result<void> valid = validate(asked); !valid.ok()) return valid.error();
    const VerifyOptions options = options_for(asked, views.camera1, views.camera2);
    MatchedViews inliers_only = views;
    inliers_only.matches = geometry.inliers;
    const Result<TwoViewProblem> made = make_two_view_problem(inliers_only, options.max_error_px);
    if (!made.ok()) return made.error();
    const TwoViewProblem& problem = *made;
    const auto fewest = static_cast<std::size_t>(options.min_inliers);
    if (problem.matches.size() < fewest) return too_few(problem.matches.size(), fewest);

    RobustModel stored{geometry.matrix, {}};
    for (std::uint32_t i = 0; i < problem.matches.size(); ++i) stored.inliers.push_back(i);
    const IntrinsicPair& k = problem.intrinsics;
    TwoViewModel model;
    switch (geometry.kind) {
        case TwoViewKind::kEssential:
            model = fit_pose(problem, geometry.cam2_from_cam1, stored.inliers, options);
            break;
        case TwoViewKind::kFundamental:
            if (problem.calibrated) {
                stored.matrix = k.k2.transpose() * geometry.matrix * k.k1;
                model = fit_essential(problem, stored, options);
            } else {
                model = fit_fundamental(problem, stored, options);
            }
            break;
        case TwoViewKind::kPlanar:
            model = fit_homography(problem, stored, std::nullopt, options);
            break;
        case TwoViewKind::kPureRotation:
            // Focal lengths that a panorama suggests are wrong as a rule, and a turn that is seen
            // through wrong ones looks like a step before a plane.
            model = fit_turn(problem, stored);
            break;
    }
    TwoViewGeometry seen = geometry_of(problem, model);
    if (seen.inliers.size() < fewest)
        return degenerate(seen.inliers.size(), problem.matches.size(), fewest);
    seen.still = geometry.still;
    seen.match_density = geometry.match_density;
    seen.core_density = geometry.core_density;
    return seen;
}

}  // namespace psfm
