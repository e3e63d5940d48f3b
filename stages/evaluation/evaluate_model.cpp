// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/evaluation/evaluate_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/median.h"

namespace psfm {
namespace {

std::vector<Eigen::Vector3d> centres_of(std::span<const NamedPose> poses) {
    std::vector<Eigen::Vector3d> centres;
    centres.reserve(poses.size());
    for (const NamedPose& pose : poses)
        centres.push_back(pose.cam_from_world.target_origin_in_source());
    return centres;
}

/// Turns an alignment about the line through the centres to fit the cameras' orientations.
/// With A_i = world_from_cam(reference) * cam_from_world(model) the rotation that image i asks for,
/// and R the present one, it maximises sum trace(A_i^T Rot(axis, t) R), which is a cos t + b sin t
/// + const.
void turn_about_line(Sim3& reference_from_model, const Eigen::Vector3d& axis,
                     std::span<const Eigen::Quaterniond> wanted, const Eigen::Vector3d& pivot) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Eigen::Quaterniond& rotation : wanted) {
        sum += (reference_from_model.rotation * rotation.conjugate()).toRotationMatrix();
    }
    Eigen::Matrix3d cross;
    cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
    const double a = sum.trace() - axis.dot(sum * axis);
    const double b = (cross * sum).trace();
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(std::atan2(b, a), axis));
    reference_from_model.rotation = (turn * reference_from_model.rotation).normalized();
    reference_from_model.translation = turn * (reference_from_model.translation - pivot) + pivot;
}

}  // namespace

Result<void> validate(const EvaluationOptions& options) {
    if (!(options.min_spacing_ratio >= 0.0 && options.min_spacing_ratio <= 1.0)) {
        return Error{ErrorCode::kInvalidArgument, "min_spacing_ratio is outside 0 to 1"};
    }
    return validate(options.alignment);
}

Result<double> outlier_threshold(std::span<const NamedPose> reference,
                                 const EvaluationOptions& options) {
    if (const auto valid = validate(options); !valid.ok()) return valid.error();
    if (reference.size() < 2) {
        return Error{ErrorCode::kTooFewMatches, "the reference has fewer than two cameras"};
    }
    const std::vector<Eigen::Vector3d> centres = centres_of(reference);
    std::vector<double> nearest(centres.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < centres.size(); ++i) {
        for (std::size_t j = i + 1; j < centres.size(); ++j) {
            const double distance = (centres[i] - centres[j]).norm();
            nearest[i] = std::min(nearest[i], distance);
            nearest[j] = std::min(nearest[j], distance);
        }
    }
    const double smallest = *std::ranges::min_element(nearest);
    const double threshold =
        0.5 * std::max(smallest, options.min_spacing_ratio * median_or(nearest, 0.0));
    if (!(threshold > 0.0)) {
        return Error{
            ErrorCode::kDegenerate,
            "most cameras of the reference are in one place, so positions cannot be judged"};
    }
    return threshold;
}

Result<ModelEvaluation> evaluate_model(std::span<const NamedPose> reference,
                                       std::span<const NamedPose> model,
                                       const EvaluationOptions& options) {
    const auto threshold = outlier_threshold(reference, options);
    if (!threshold.ok()) return threshold.error();
    const std::vector<NameMatch> matches = match_by_name(reference, model);
    if (matches.size() < 3) {
        return Error{
            ErrorCode::kTooFewMatches,
            "only " + std::to_string(matches.size()) + " of the model's " +
                std::to_string(model.size()) +
                " images are in the reference, three are needed to align it: check that both "
                "have the same image names"};
    }
    const std::vector<Eigen::Vector3d> reference_centres = centres_of(reference);
    const std::vector<Eigen::Vector3d> model_centres = centres_of(model);
    std::vector<Eigen::Vector3d> source;
    std::vector<Eigen::Vector3d> target;
    for (const NameMatch& match : matches) {
        source.push_back(model_centres[match.model]);
        target.push_back(reference_centres[match.reference]);
    }
    auto alignment = align_robustly(source, target, *threshold, options.alignment);
    if (!alignment.ok()) {
        return Error{alignment.error().code,
                     "the model cannot be aligned: " + alignment.error().message};
    }
    if (alignment->collinear) {
        std::vector<Eigen::Quaterniond> wanted;
        Eigen::Vector3d first = target[alignment->inliers.front()];
        Eigen::Vector3d farthest = first;
        for (const std::uint32_t i : alignment->inliers) {
            wanted.push_back(reference[matches[i].reference].cam_from_world.rotation.conjugate() *
                             model[matches[i].model].cam_from_world.rotation);
            if ((target[i] - first).norm() > (farthest - first).norm()) farthest = target[i];
        }
        turn_about_line(alignment->target_from_source, (farthest - first).normalized(), wanted,
                        first);
    }

    ModelEvaluation result;
    result.registered = model.size();
    result.outlier_threshold = *threshold;
    result.reference_from_model = alignment->target_from_source;
    result.consensus = alignment->consensus;
    std::vector<double> positions;
    std::vector<double> rotations;
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < matches.size(); ++i) {
        const NamedPose& truth = reference[matches[i].reference];
        const Rigid3 aligned =
            transform_pose(model[matches[i].model].cam_from_world, result.reference_from_model);
        ImageError error;
        error.name = truth.name;
        error.position = (result.reference_from_model * source[i] - target[i]).norm();
        error.rotation_deg =
            kDegreesPerRadian * angle_between(aligned.rotation, truth.cam_from_world.rotation);
        error.outlier = error.position > *threshold;
        result.outliers += error.outlier ? 1 : 0;
        positions.push_back(error.position);
        rotations.push_back(error.rotation_deg);
        sum += error.position;
        squares += error.position * error.position;
        result.images.push_back(std::move(error));
    }
    const auto count = static_cast<double>(matches.size());
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& centre : reference_centres) box.extend(centre);
    result.position_mean = sum / count;
    result.position_median = median_or(positions, 0.0);
    result.position_rms = std::sqrt(squares / count);
    result.position_relative = result.position_rms / box.diagonal().norm();
    result.rotation_median_deg = median_or(rotations, 0.0);
    result.rotation_max_deg = *std::ranges::max_element(rotations);
    return result;
}

Result<std::size_t> summed_outliers(std::span<const NamedPose> reference,
                                    std::span<const std::vector<NamedPose>> models,
                                    std::size_t min_cameras, const EvaluationOptions& options) {
    if (const auto threshold = outlier_threshold(reference, options); !threshold.ok())
        return threshold.error();
    std::size_t outliers = 0;
    for (const std::vector<NamedPose>& model : models) {
        if (model.size() < min_cameras) continue;
        const auto evaluation = evaluate_model(reference, model, options);
        if (evaluation.ok()) {
            outliers += evaluation->outliers;
            // Expected: of a model without three images of the reference nothing can be said
        } else if (evaluation.error().code == ErrorCode::kDegenerate) {
            outliers += match_by_name(reference, model).size();
        }
    }
    return outliers;
}

}  // namespace psfm
