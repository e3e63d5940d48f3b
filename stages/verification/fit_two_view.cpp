// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/fit_two_view.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "stages/algorithms/math/decompositions.h"
#include "stages/algorithms/two_view/decompose_two_view.h"
#include "stages/algorithms/two_view/refine_two_view.h"

namespace psfm {
namespace {

/// Guard: refinement and inliers settle in two rounds: a third changes nothing that can be
/// measured.
constexpr int kRounds = 2;

/// Guard: fewer points than this are not worth a refinement with five or seven parameters.
/// VerifyOptions ask for more of a verified pair.
constexpr std::size_t kMinRefinable = 10;

RefineOptions refine_options(double loss_scale) {
    RefineOptions options;
    options.loss_scale = loss_scale;
    return options;
}

/// Sum over the matches of 1 - (error / max_error)^2, as in MSAC: tells poses with equal counts
/// apart.
double score(const TwoViewProblem& problem, const TwoViewModel& model, double max_error_px) {
    const Eigen::Matrix3d f = fundamental_from_pose(model.cam2_from_cam1, problem.intrinsics);
    double sum = 0.0;
    for (const std::uint32_t i : model.inliers) {
        const double relative = sampson_residual(f, problem.pixels[i]) / max_error_px;
        sum += 1.0 - relative * relative;
    }
    return sum;
}

/// The rotation that brings the first image's rays closest to the second's (Kabsch).
Eigen::Quaterniond aligning_rotation(const TwoViewProblem& problem, const Indices& indices) {
    Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
    for (const std::uint32_t i : indices) {
        const PointPair& p = problem.normalized[i];
        correlation +=
            p.x2.homogeneous().normalized() * p.x1.homogeneous().normalized().transpose();
    }
    const SingularValues svd = singular_values(correlation);
    const double sign = (svd.u * svd.v.transpose()).determinant() < 0 ? -1.0 : 1.0;
    const Eigen::Matrix3d rotation =
        svd.u * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.v.transpose();
    return Eigen::Quaterniond(rotation).normalized();
}

/// The problem as seen with both focal lengths multiplied by a factor (distortion left as it is).
TwoViewProblem with_focal_factor(const TwoViewProblem& problem, double factor) {
    TwoViewProblem scaled = problem;
    for (Eigen::Matrix3d* k : {&scaled.intrinsics.k1, &scaled.intrinsics.k2}) {
        (*k)(0, 0) *= factor;
        (*k)(1, 1) *= factor;
    }
    for (PointPair& p : scaled.normalized) {
        p.x1 /= factor;
        p.x2 /= factor;
    }
    return scaled;
}

TwoViewModel fit_rotation(const TwoViewProblem& problem, const RobustModel& homography,
                          const VerifyOptions& options) {
    TwoViewModel model;
    model.kind = TwoViewKind::kPureRotation;
    model.matrix = homography.matrix;
    model.inliers = homography.inliers;
    for (int round = 0; round < kRounds; ++round) {
        if (model.inliers.size() < 3) break;
        model.cam2_from_cam1.rotation = aligning_rotation(problem, model.inliers);
        model.inliers =
            inliers_of_rotation(problem, model.cam2_from_cam1.rotation, options.max_error_px);
    }
    return model;
}

/// With unknown focal lengths a turn looks like one only through the right ones: common factors to
/// the guess are tried, half to double in steps of about a tenth, and then ever smaller steps from
/// the best: 5 % off, the corners of photographs 20 degrees apart are beside their place by 4 px.
TwoViewModel fit_rotation_any_focal(const TwoViewProblem& problem, const RobustModel& homography,
                                    const VerifyOptions& options) {
    if (problem.calibrated) return fit_rotation(problem, homography, options);
    TwoViewModel best;
    double best_exponent = 0.0;
    const auto attempt = [&](double exponent) {
        const TwoViewProblem scaled = with_focal_factor(problem, std::exp2(exponent));
        TwoViewModel model = fit_rotation(scaled, homography, options);
        if (model.inliers.size() <= best.inliers.size()) return;
        best = std::move(model);
        best_exponent = exponent;
    };
    for (int step = -8; step <= 8; ++step) attempt(step / 8.0);
    for (double step = 1.0 / 16.0; step > 1.0 / 128.0; step /= 2.0) {
        const double from = best_exponent;
        attempt(from - step);
        attempt(from + step);
    }
    // The pose is that of the guess, as for every pair with an unknown focal length.
    if (!best.inliers.empty())
        best.cam2_from_cam1.rotation = aligning_rotation(problem, best.inliers);
    return best;
}

}  // namespace

TwoViewModel fit_turn(const TwoViewProblem& problem, const RobustModel& homography) {
    TwoViewModel model{TwoViewKind::kPureRotation, homography.matrix, {}, homography.inliers};
    model.cam2_from_cam1.rotation = aligning_rotation(problem, model.inliers);
    return model;
}

TwoViewModel fit_pose(const TwoViewProblem& problem, const Rigid3& start, const Indices& inliers,
                      const VerifyOptions& options) {
    TwoViewModel model{TwoViewKind::kEssential, Eigen::Matrix3d::Zero(), start, inliers};
    for (int round = 0; round < kRounds; ++round) {
        if (model.inliers.size() < kMinRefinable) break;
        model.cam2_from_cam1 =
            refine_relative_pose(select(problem.pixels, model.inliers), problem.intrinsics,
                                 model.cam2_from_cam1, refine_options(options.refine_loss_px));
        const Indices refined_by = std::exchange(
            model.inliers, inliers_of_pose(problem, model.cam2_from_cam1, options.max_error_px));
        if (model.inliers == refined_by) break;
    }
    model.matrix = fundamental_from_pose(model.cam2_from_cam1, {}).normalized();
    return model;
}

TwoViewModel fit_essential(const TwoViewProblem& problem, const RobustModel& essential,
                           const VerifyOptions& options) {
    const std::vector<Rigid3> candidates = poses_from_essential(essential.matrix);
    const PoseChoice choice =
        choose_by_cheirality(candidates, select(problem.normalized, essential.inliers));
    return fit_pose(problem, choice.cam2_from_cam1, essential.inliers, options);
}

TwoViewModel fit_fundamental(const TwoViewProblem& problem, const RobustModel& fundamental,
                             const VerifyOptions& options) {
    // Unit scale for the refinement: pixels divided by the mean guess, from the principal points.
    const double unit = 0.5 * (problem.intrinsics.k1(0, 0) + problem.intrinsics.k2(0, 0));
    Eigen::Matrix3d pixel1 = Eigen::Vector3d(unit, unit, 1).asDiagonal();
    Eigen::Matrix3d pixel2 = pixel1;
    pixel1.topRightCorner<2, 1>() = problem.intrinsics.k1.topRightCorner<2, 1>();
    pixel2.topRightCorner<2, 1>() = problem.intrinsics.k2.topRightCorner<2, 1>();
    const Eigen::Vector2d origin1 = pixel1.topRightCorner<2, 1>();
    const Eigen::Vector2d origin2 = pixel2.topRightCorner<2, 1>();

    TwoViewModel model{TwoViewKind::kFundamental, fundamental.matrix, {}, fundamental.inliers};
    for (int round = 0; round < kRounds; ++round) {
        if (model.inliers.size() < kMinRefinable) break;
        std::vector<PointPair> points = select(problem.pixels, model.inliers);
        for (PointPair& p : points) p = {(p.x1 - origin1) / unit, (p.x2 - origin2) / unit};
        const Eigen::Matrix3d scaled =
            refine_fundamental(points, pixel2.transpose() * model.matrix * pixel1,
                               refine_options(options.refine_loss_px / unit));
        model.matrix = (pixel2.inverse().transpose() * scaled * pixel1.inverse()).normalized();
        model.inliers = inliers_of_fundamental(problem, model.matrix, options.max_error_px);
    }
    const std::vector<Rigid3> candidates = poses_from_essential(
        problem.intrinsics.k2.transpose() * model.matrix * problem.intrinsics.k1);
    model.cam2_from_cam1 =
        choose_by_cheirality(candidates, select(problem.normalized, model.inliers)).cam2_from_cam1;
    return model;
}

TwoViewModel fit_homography(const TwoViewProblem& problem, const RobustModel& homography,
                            const std::optional<TwoViewModel>& general,
                            const VerifyOptions& options) {
    TwoViewModel rotation = fit_rotation_any_focal(problem, homography, options);
    if (static_cast<double>(rotation.inliers.size()) >=
        options.rotation_ratio * static_cast<double>(homography.inliers.size())) {
        return rotation;
    }
    const Eigen::Matrix3d normalized_homography =
        problem.intrinsics.k2.inverse() * homography.matrix * problem.intrinsics.k1;
    const std::vector<Rigid3> candidates = poses_from_homography(normalized_homography);
    TwoViewModel best{TwoViewKind::kPlanar, homography.matrix, {}, {}};
    if (problem.calibrated) {
        double best_score = 0.0;
        if (general) {
            best.cam2_from_cam1 = general->cam2_from_cam1;
            best.inliers = general->inliers;
            best_score = score(problem, *general, options.max_error_px);
        }
        for (const Rigid3& candidate : candidates) {
            const TwoViewModel model = fit_pose(problem, candidate, homography.inliers, options);
            const double model_score = score(problem, model, options.max_error_px);
            if (model_score <= best_score) continue;
            best_score = model_score;
            best.cam2_from_cam1 = model.cam2_from_cam1;
            best.inliers = model.inliers;
        }
        return best;
    }
    const bool more_off_plane = general && general->inliers.size() > homography.inliers.size();
    best.inliers = more_off_plane ? general->inliers : homography.inliers;
    const std::vector<PointPair> points = select(problem.normalized, best.inliers);
    if (!candidates.empty()) {
        best.cam2_from_cam1 = choose_by_cheirality(candidates, points).cam2_from_cam1;
    } else if (general) {
        best.cam2_from_cam1 = general->cam2_from_cam1;
    }
    return best;
}

}  // namespace psfm
