// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/pose/absolute_pose.h"

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <array>
#include <cmath>
#include <deque>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <string>

#include "stages/algorithms/adjustment/reprojection_cost.h"

namespace psfm {
namespace {

/// Guard: of finding a sample without outliers, for a sample costs little. OpenCV's default is
/// 0.99; ours, not tuned.
constexpr double kPoseConfidence = 0.99999;
/// Guard: loss of the refinement [px]: observations that are off by more pull less. Ours; not
/// tuned.
constexpr double kPoseLossPx = 1.0;
constexpr int kPoseIterations = 50;  // Guard: ends the loop
/// Guard: turns [rad] that have no axis.
constexpr double kNoPoseTurn = 1e-12;
/// Mathematics: points that determine a pose, three of them up to four solutions.
constexpr std::size_t kPointsOfPose = 4;

Camera with_focal_scaled(Camera camera, double factor) {
    camera.params[0] *= factor;
    if (camera.has_two_focals()) camera.params[1] *= factor;
    return camera;
}

std::vector<std::uint32_t> inliers_of(std::span<const Eigen::Vector2d> pixels,
                                      std::span<const Eigen::Vector3d> points, const Camera& camera,
                                      const Rigid3& cam_from_world, double max_error_px) {
    std::vector<std::uint32_t> inliers;
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
        const auto projected = project(camera, cam_from_world * points[i]);
        if (projected && (*projected - pixels[i]).norm() <= max_error_px) inliers.push_back(i);
    }
    return inliers;
}

/// P3P with OpenCV's USAC on undistorted pixels (origin at the principal point).
std::optional<AbsolutePose> sample_pose(std::span<const Eigen::Vector2d> pixels,
                                        std::span<const Eigen::Vector3d> points,
                                        const Camera& camera, const AbsolutePoseOptions& options,
                                        std::uint64_t seed) {
    const double focal = camera.mean_focal();
    std::vector<cv::Point2d> image_points;
    std::vector<cv::Point3d> object_points;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const Eigen::Vector2d x = focal * normalized_from_pixel(camera, pixels[i]);
        image_points.emplace_back(x.x(), x.y());
        object_points.emplace_back(points[i].x(), points[i].y(), points[i].z());
    }
    cv::Mat matrix = (cv::Mat_<double>(3, 3) << focal, 0, 0, 0, focal, 0, 0, 0, 1);
    cv::UsacParams usac;
    usac.confidence = kPoseConfidence;
    usac.isParallel = false;
    usac.maxIterations = options.max_iterations;
    usac.randomGeneratorState = static_cast<int>(seed & 0x7FFFFFFFU);
    usac.threshold = options.max_error_px;
    usac.score = cv::SCORE_METHOD_MSAC;
    usac.sampler = cv::SAMPLING_UNIFORM;
    usac.loMethod = cv::LOCAL_OPTIM_INNER_LO;
    cv::Mat rotation_vector;
    cv::Mat translation;
    cv::Mat inlier_indices;
    try {
        const bool found = cv::solvePnPRansac(object_points, image_points, matrix, cv::noArray(),
                                              rotation_vector, translation, inlier_indices, usac);
        if (!found || rotation_vector.total() != 3 || translation.total() != 3) return std::nullopt;
    } catch (const cv::Exception&) {
        return std::nullopt;  // degenerate samples only: OpenCV reports them this way
    }
    rotation_vector.convertTo(rotation_vector, CV_64F);
    translation.convertTo(translation, CV_64F);
    const Eigen::Vector3d w(rotation_vector.at<double>(0), rotation_vector.at<double>(1),
                            rotation_vector.at<double>(2));
    AbsolutePose pose;
    const double angle = w.norm();
    if (angle > kNoPoseTurn) pose.cam_from_world.rotation = Eigen::AngleAxisd(angle, w / angle);
    pose.cam_from_world.translation = {translation.at<double>(0), translation.at<double>(1),
                                       translation.at<double>(2)};
    if (!pose.cam_from_world.translation.allFinite() ||
        !pose.cam_from_world.rotation.coeffs().allFinite())
        return std::nullopt;
    pose.camera = camera;
    pose.inliers = inliers_of(pixels, points, camera, pose.cam_from_world, options.max_error_px);
    return pose;
}

/// Pose, and focal length and distortion if asked for, on the inliers; points fixed.
void refine_pose(std::span<const Eigen::Vector2d> pixels, std::span<const Eigen::Vector3d> points,
                 bool refine_focal, AbsolutePose& pose) {
    std::array<double, kPoseSize + kIntrinsicsSize> values{};
    double* pose_block = values.data();
    double* intrinsics = values.data() + kPoseSize;
    write_pose(pose.cam_from_world, pose_block);
    std::ranges::copy(pose.camera.params, intrinsics);
    std::vector<Eigen::Vector3d> fixed_points;
    fixed_points.reserve(pose.inliers.size());
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.disable_all_safety_checks = true;
    ceres::CauchyLoss loss(kPoseLossPx);
    PoseManifold manifold;
    std::deque<ReprojectionCost> costs;
    ceres::Problem problem(problem_options);
    for (const std::uint32_t i : pose.inliers) {
        fixed_points.push_back(points[i]);
        costs.emplace_back(pose.camera.model, pixels[i], 1.0);
        problem.AddResidualBlock(&costs.back(), &loss, pose_block, fixed_points.back().data(),
                                 intrinsics);
        problem.SetParameterBlockConstant(fixed_points.back().data());
    }
    problem.SetManifold(pose_block, &manifold);
    std::vector<int> fixed = pose.camera.has_two_focals() ? std::vector<int>{2, 3, 4, 5, 6, 7}
                                                          : std::vector<int>{1, 2, 3, 4, 5, 6, 7};
    ceres::SubsetManifold focal_only(kIntrinsicsSize, fixed);
    if (refine_focal) {
        problem.SetManifold(intrinsics, &focal_only);
    } else {
        problem.SetParameterBlockConstant(intrinsics);
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.max_num_iterations = kPoseIterations;
    solver.num_threads = 1;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable()) return;
    Camera refined = pose.camera;
    std::copy_n(intrinsics, kIntrinsicsSize, refined.params.begin());
    if (!validate(refined).ok()) return;  // Expected: the pose stays as it was found
    pose.camera = refined;
    pose.cam_from_world = read_pose(pose_block);
}

}  // namespace

Result<void> validate(const AbsolutePoseOptions& options) {
    if (!(options.max_error_px > 0) || options.min_inliers < kPointsOfPose ||
        options.min_inlier_ratio < 0 || options.min_inlier_ratio > 1 ||
        options.max_iterations < 1) {
        return Error{ErrorCode::kInvalidArgument,
                     "absolute pose: error bound and iterations must be positive, at least 4 "
                     "inliers, ratio in 0..1"};
    }
    return {};
}

Result<AbsolutePose> estimate_absolute_pose(std::span<const Eigen::Vector2d> pixels,
                                            std::span<const Eigen::Vector3d> points,
                                            const Camera& camera, bool refine_focal,
                                            const AbsolutePoseOptions& options,
                                            std::uint64_t seed) {
    if (pixels.size() < options.min_inliers) {
        return Error{ErrorCode::kTooFewMatches, std::to_string(pixels.size()) + " points seen"};
    }
    // Guard: a sample from 0.6 to 1.67 times the guess, wide-angle to portrait lenses where that is
    // 1.2 image widths; what lies between is for the refinement.
    static constexpr std::array<double, 7> kFocalFactors{1.0, 0.85, 1.18, 0.72, 1.39, 0.6, 1.67};
    const std::size_t factors = refine_focal ? kFocalFactors.size() : 1;
    std::optional<AbsolutePose> best;
    for (std::size_t i = 0; i < factors; ++i) {
        auto sampled = sample_pose(pixels, points, with_focal_scaled(camera, kFocalFactors.at(i)),
                                   options, seed);
        if (sampled && (!best || sampled->inliers.size() > best->inliers.size()))
            best = std::move(sampled);
    }
    if (!best) return Error{ErrorCode::kDegenerate, "no pose agrees with the points"};
    if (best->inliers.size() >= kPointsOfPose) {
        refine_pose(pixels, points, refine_focal, *best);
        best->inliers =
            inliers_of(pixels, points, best->camera, best->cam_from_world, options.max_error_px);
    }
    if (best->inliers.size() < options.min_inliers ||
        static_cast<double>(best->inliers.size()) <
            options.min_inlier_ratio * static_cast<double>(pixels.size())) {
        return Error{ErrorCode::kTooFewMatches, std::to_string(best->inliers.size()) + " of " +
                                                    std::to_string(pixels.size()) +
                                                    " points agree on a pose"};
    }
    return *std::move(best);
}

}  // namespace psfm
