// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// verify_pair: which of the matches are of the scene, and then its geometry.
#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "stages/verification/find_still.h"
#include "stages/verification/match_density.h"
#include "stages/verification/verify_matches.h"
#include "stages/verification/verify_pair.h"

namespace psfm {
namespace {

using Matches = std::vector<FeatureMatch>;

Matches sorted(std::span<const FeatureMatch> matches) {
    Matches result(matches.begin(), matches.end());
    std::ranges::sort(result);
    return result;
}

std::size_t count_common(const Matches& a, const Matches& b) {
    Matches common;
    std::ranges::set_intersection(a, b, std::back_inserter(common));
    return common.size();
}

double part(std::size_t count, std::size_t of) {
    return of == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(of);
}

MatchedViews with_matches(const MatchedViews& views, const Matches& matches) {
    MatchedViews some = views;
    some.matches = matches;
    return some;
}

/// How many of the matches agree with a geometry that others were asked for.
std::size_t count_agreeing(const MatchedViews& views, const TwoViewGeometry& geometry,
                           double max_error_px) {
    const auto problem = make_two_view_problem(views, max_error_px);
    if (!problem.ok()) return 0;  // Expected: what no problem can be made of agrees with nothing
    switch (geometry.kind) {
        case TwoViewKind::kFundamental:
            return inliers_of_fundamental(*problem, geometry.matrix, max_error_px).size();
        case TwoViewKind::kEssential:
            return inliers_of_pose(*problem, geometry.cam2_from_cam1, max_error_px).size();
        case TwoViewKind::kPlanar:
            if (problem->calibrated)
                return inliers_of_pose(*problem, geometry.cam2_from_cam1, max_error_px).size();
            break;
        case TwoViewKind::kPureRotation:
            break;
    }
    return static_cast<std::size_t>(
        std::ranges::count_if(problem->pixels, [&](const PointPair& pair) {
            const Eigen::Vector3d there = geometry.matrix * pair.x1.homogeneous();
            return (there.hnormalized() - pair.x2).norm() <= max_error_px;
        }));
}

/// A rotation by nothing, which no inlier stands for.
TwoViewGeometry still_only(Matches still) {
    TwoViewGeometry geometry;
    geometry.kind = TwoViewKind::kPureRotation;
    geometry.matrix = Eigen::Matrix3d::Identity().normalized();
    geometry.still = std::move(still);
    return geometry;
}

/// The geometry of what moves, where that is a scene of its own.
std::optional<TwoViewGeometry> verify_rest(const MatchedViews& views, const Matches& rest,
                                           bool still_everywhere, const VerifyOptions& options,
                                           std::uint64_t seed) {
    auto moving = verify_matches(with_matches(views, rest), options, seed);
    if (!moving.ok()) return std::nullopt;  // Expected: the rest is no scene of its own
    if (still_everywhere &&
        part(moving->inliers.size(), rest.size()) < options.still.min_moving_share)
        return std::nullopt;
    // What trembles is not what moves.
    if (median_motion_px(views, moving->inliers) <= 2.0 * options.max_error_px) return std::nullopt;
    return *std::move(moving);
}

/// verify_pair, but for how densely the images match.
Result<TwoViewGeometry> verify_scene(const MatchedViews& views, const VerifyOptions& options,
                                     std::uint64_t seed) {
    const bool all_there = std::ranges::all_of(views.matches, [&](const FeatureMatch& match) {
        return match.first < views.keypoints1.size() && match.second < views.keypoints2.size();
    });
    Matches still = all_there ? find_still(views, options.still) : Matches{};
    if (still.empty()) return verify_matches(views, options, seed);

    Matches rest;
    std::ranges::set_difference(sorted(views.matches), still, std::back_inserter(rest));
    const bool everywhere =
        still_coverage(views, still, options.still) >= options.still.min_coverage;
    std::optional<TwoViewGeometry> moving = verify_rest(views, rest, everywhere, options, seed);
    if (moving) {
        const std::size_t agreeing =
            count_agreeing(with_matches(views, still), *moving, options.max_error_px);
        if (part(agreeing, still.size()) < options.still.min_agreeing) {
            moving->still = std::move(still);
            return *std::move(moving);
        }
    }
    auto geometry = verify_matches(views, options, seed);
    if (moving) {
        // A far view: unless what moves and what does not pull against each other.
        const double kept = geometry.ok() ? part(count_common(moving->inliers, geometry->inliers),
                                                 moving->inliers.size())
                                          : 0.0;
        if (kept < options.still.min_kept) geometry = *std::move(moving);
    } else if (!everywhere) {
        const bool leans_on_still =
            !geometry.ok() || 2 * count_common(still, geometry->inliers) > geometry->inliers.size();
        if (leans_on_still && still.size() >= static_cast<std::size_t>(options.min_inliers))
            return still_only(std::move(still));
    }
    if (geometry.ok()) geometry->still = std::move(still);
    return geometry;
}

}  // namespace

Result<TwoViewGeometry> verify_pair(const MatchedViews& views, const VerifyOptions& options,
                                    std::uint64_t seed) {
    if (const Result<void> valid = validate(options); !valid.ok()) return valid.error();
    auto geometry = verify_scene(views, options_for(options, views.camera1, views.camera2), seed);
    if (!geometry.ok()) return geometry.error();
    const MatchDensity density = match_density(views, geometry->inliers);
    geometry->match_density = density.shared;
    geometry->core_density = density.core;
    return geometry;
}

}  // namespace psfm
