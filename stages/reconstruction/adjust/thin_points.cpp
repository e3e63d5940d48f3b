// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/thin_points.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "stages/algorithms/adjustment/reprojection.h"
#include "stages/algorithms/math/in_parallel.h"
#include "stages/reconstruction/model/cover_tracks.h"
#include "stages/reconstruction/model/tracks.h"

namespace psfm {
namespace {

using Feature = WorkingModel::Feature;

constexpr std::size_t kRefinedATask = 256;  // Guard: of tasks too small to pay

/// Cost of a position, and its normal equations.
struct PointSystem {
    double cost = 0.0;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

class PointRefiner {
  public:
    PointRefiner(const WorkingModel& model, const AdjustmentOptions& options)
        : model_(model), options_(options), cameras_(model.image_count()) {
        for (std::uint32_t image = 0; image < model.image_count(); ++image) {
            if (!model.registered(image)) continue;
            std::array<double, kPoseSize> pose{};
            write_pose(model.pose(image), pose.data());
            const Camera& camera = model.camera(image);
            cameras_[image] = {camera.model, pose.data(), camera.params.data()};
        }
    }

    Eigen::Vector3d refine(std::span<const Feature> track, const Eigen::Vector3d& start) const {
        constexpr int kSteps = 5;  // Guard: ends the loop
        Eigen::Vector3d position = start;
        PointSystem system = linearize(track, position);
        for (int step = 0; step < kSteps; ++step) {
            if (!(system.normal.determinant() > 0.0)) break;
            const Eigen::Vector3d moved = position - system.normal.inverse() * system.gradient;
            if (!moved.allFinite()) break;
            const PointSystem next = linearize(track, moved);
            if (!(next.cost < system.cost)) break;
            const bool converged =
                system.cost - next.cost < options_.function_tolerance * system.cost;
            position = moved;
            system = next;
            if (converged) break;
        }
        return position;
    }

  private:
    PointSystem linearize(std::span<const Feature> track, const Eigen::Vector3d& position) const {
        PointSystem system;
        for (const Feature& feature : track) {
            const Reprojection seen(cameras_[feature.image], position);
            if (!seen.in_front()) {
                system.cost = std::numeric_limits<double>::infinity();
                return system;
            }
            const double inverse_sigma =
                1.0 / observation_sigma(model_.keypoint(feature), options_);
            const Eigen::Vector2d residual = inverse_sigma * (seen.pixel() - model_.pixel(feature));
            const SoftLOne loss(residual.squaredNorm(), options_.loss_scale_px);
            const auto by_point = seen.by_point(inverse_sigma);
            const double weight = 1.0 / loss.inverse_slope();
            system.cost += loss.half_loss();
            system.normal += weight * by_point.transpose() * by_point;
            system.gradient += weight * by_point.transpose() * residual;
        }
        return system;
    }

    const WorkingModel& model_;
    const AdjustmentOptions& options_;
    std::vector<PosedCamera> cameras_;  // by image; unset where one is not placed
};

}  // namespace

std::vector<std::uint32_t> covering_points(const WorkingModel& model,
                                           std::span<const std::uint32_t> images,
                                           std::uint32_t points_per_image) {
    std::vector<bool> counts(model.image_count(), false);
    for (const std::uint32_t image : images) counts[image] = true;
    const std::vector<std::uint32_t> points = points_seen_by(model, images);
    std::vector<FeatureTrack> within(images.empty() ? 0 : points.size());
    std::vector<std::span<const Feature>> tracks;
    tracks.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const FeatureTrack& track = model.points()[points[i]].track;
        if (!images.empty()) {
            std::ranges::copy_if(track, std::back_inserter(within[i]),
                                 [&](const Feature& feature) { return counts[feature.image]; });
        }
        tracks.emplace_back(images.empty() ? track : within[i]);
    }
    std::vector<std::uint32_t> chosen = cover_tracks(tracks, model.image_count(), points_per_image);
    for (std::uint32_t& track : chosen) track = points[track];
    std::ranges::sort(chosen);
    return chosen;
}

void refine_points(WorkingModel& model, std::span<const std::uint32_t> points,
                   const AdjustmentOptions& options) {
    const PointRefiner refiner(model, options);
    std::vector<Eigen::Vector3d> moved(points.size());
    in_parallel(points.size(), kRefinedATask, [&](std::size_t i) {
        const WorkingModel::Point& point = model.points()[points[i]];
        moved[i] = refiner.refine(point.track, point.position);
    });
    for (std::size_t i = 0; i < points.size(); ++i) model.set_position(points[i], moved[i]);
}

}  // namespace psfm
