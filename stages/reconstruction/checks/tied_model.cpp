// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/tied_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "graph/camera_lens.h"
#include "graph/sorted_unique.h"
#include "stages/algorithms/adjustment/reprojection.h"
#include "stages/algorithms/pose/absolute_pose.h"
#include "stages/reconstruction/adjust/thin_points.h"
#include "stages/reconstruction/checks/judge_lenses.h"
#include "stages/reconstruction/checks/model_alone.h"

namespace psfm {
namespace {

bool deviates(const ReleasedCamera& camera, const TieOptions& options) {
    const double step = std::abs(std::log(camera.own_focal_px / camera.tied_focal_px));
    const double excused = options.excused_px * options.excused_px;  // half of two coordinates
    return camera.observations >= options.min_observations &&
           camera.tied_cost + excused >= options.min_gain * (camera.own_cost + excused) &&
           step >= options.min_deviation;
}

/// Losses of some points' observations, by image.
std::map<ImageId, Costs> costs_of(const WorkingModel& model,
                                  const std::vector<std::uint32_t>& points,
                                  const AdjustmentOptions& options) {
    constexpr double kWorst = 100.0;  // Guard: squared, of what has come to lie behind its camera
    std::map<ImageId, Costs> costs;
    for (const std::uint32_t p : points) {
        const WorkingModel::Point& point = model.points()[p];
        for (const WorkingModel::Feature& feature : point.track) {
            const double sigma = observation_sigma(model.keypoint(feature), options);
            const double error = model.squared_error(feature, point.position) / (sigma * sigma);
            Costs& of_image = costs[model.image_id(feature.image)];
            of_image.sum +=
                SoftLOne(std::isfinite(error) ? error : kWorst, options.loss_scale_px).half_loss();
            ++of_image.observations;
        }
    }
    return costs;
}

void give_second_coefficient(WorkingModel& model) {
    for (const auto& [id, camera] : model.cameras()) {
        if (has_one_coefficient(camera)) model.mutable_camera(id).model = CameraModel::kRadial;
    }
}

AdjustmentOptions adjustment_of(const TieOptions& options) {
    constexpr double kTolerance = 1e-4;  // Guard: of time. Ours; not tuned
    return {.loss_scale_px = 1.0,
            .max_iterations = options.max_iterations,
            .function_tolerance = kTolerance};
}

/// What an image sees of some points.
struct LensViews {
    std::vector<std::uint32_t> points;
    std::vector<WorkingModel::Feature> features;  ///< as points
};

/// Takes images out of a model. @return what they see of those points that are left of the given
/// ones, by image
std::vector<LensViews> take_out(WorkingModel& model, const std::vector<std::uint32_t>& images,
                                const std::vector<std::uint32_t>& points) {
    std::vector<LensViews> sights(images.size());
    for (const std::uint32_t point : points) {
        for (const WorkingModel::Feature& feature : model.points()[point].track) {
            const auto image = std::ranges::find(images, feature.image);
            if (image == images.end()) continue;
            LensViews& seen = sights[static_cast<std::size_t>(image - images.begin())];
            seen.points.push_back(point);
            seen.features.push_back(feature);
        }
    }
    for (const std::uint32_t image : images) model.remove_image(image);
    for (LensViews& seen : sights) {
        LensViews left;
        for (std::size_t i = 0; i < seen.points.size(); ++i) {
            if (!model.points()[seen.points[i]].alive()) continue;
            left.points.push_back(seen.points[i]);
            left.features.push_back(seen.features[i]);
        }
        seen = std::move(left);
    }
    return sights;
}

/// Places an image anew, by points that others know. @return whether it has found a place
bool place_again(WorkingModel& model, std::uint32_t image, const LensViews& sights) {
    std::vector<Eigen::Vector2d> pixels;
    std::vector<Eigen::Vector3d> positions;
    for (std::size_t i = 0; i < sights.points.size(); ++i) {
        pixels.push_back(model.pixel(sights.features[i]));
        positions.push_back(model.points()[sights.points[i]].position);
    }
    const auto pose = estimate_absolute_pose(pixels, positions, model.camera(image), false, {}, 0);
    if (!pose.ok()) return false;  // Expected: it cannot have this lens
    model.set_pose(image, pose->cam_from_world);
    for (std::size_t i = 0; i < sights.points.size(); ++i)
        model.add_observation(sights.points[i], sights.features[i]);
    return true;
}

/// What the points that some images see, of those given, cost with another lens.
/// @param model  a copy
double cost_with_lens(WorkingModel model, CameraId camera, const std::vector<std::uint32_t>& images,
                      const std::vector<std::uint32_t>& points, const Camera& lens,
                      const TieOptions& options) {
    constexpr double kImpossible = std::numeric_limits<double>::infinity();
    const AdjustmentOptions adjustment = adjustment_of(options);
    const std::vector<LensViews> sights = take_out(model, images, points);
    std::vector<std::uint32_t> seen;
    for (const LensViews& of_image : sights)
        seen.insert(seen.end(), of_image.points.begin(), of_image.points.end());
    sort_unique(seen);
    refine_points(model, seen, adjustment);
    model.mutable_camera(camera) = with_lens_of(model.cameras().at(camera), lens);
    for (std::size_t i = 0; i < images.size(); ++i) {
        if (!place_again(model, images[i], sights[i])) return kImpossible;
    }
    AdjustmentScope scope;
    scope.free_images = scope.point_images = images;
    scope.points = seen;
    // Expected: or its images have no place with such a lens
    if (!adjust(model, scope, adjustment).ok()) return kImpossible;
    double cost = 0.0;
    for (const auto& [image, of_image] : costs_of(model, seen, adjustment)) cost += of_image.sum;
    return cost;
}

}  // namespace

TiedModel adjust_tied(const std::shared_ptr<const Reconstruction>& model,
                      const ClusterProblem& problem, const CameraTies& ties,
                      std::uint32_t coefficients, const TieOptions& options) {
    ModelAlone alone(model, problem, ties);
    WorkingModel& working = alone.model;
    if (coefficients > 1) give_second_coefficient(working);
    AdjustmentScope scope = full_scope(working, true);
    scope.points = covering_points(working, {}, options.points_per_image);
    const AdjustmentOptions adjustment = adjustment_of(options);
    // Expected: ties that no model of theirs can be adjusted with are told by nothing
    if (!adjust(working, scope, adjustment).ok()) return {};
    std::vector<std::uint32_t> others;
    for (std::uint32_t point = 0; point < working.points().size(); ++point) {
        if (!std::ranges::binary_search(*scope.points, point)) others.push_back(point);
    }
    refine_points(working, others, adjustment);
    return {std::make_shared<const Reconstruction>(working.save()),
            costs_of(working, *scope.points, adjustment)};
}

std::map<CameraId, std::vector<double>> costs_by_lens(
    const std::shared_ptr<const Reconstruction>& model, const ClusterProblem& problem,
    std::span<const CameraId> cameras, std::span<const Camera> lenses, const TieOptions& options) {
    ModelAlone alone(model, problem, untied(problem));
    std::map<CameraId, std::vector<std::uint32_t>> images_of;
    for (std::uint32_t image = 0; image < alone.model.image_count(); ++image) {
        if (alone.model.registered(image)) images_of[alone.model.camera_id(image)].push_back(image);
    }
    const std::vector<std::uint32_t> points =
        covering_points(alone.model, {}, options.points_per_image);
    std::map<CameraId, std::vector<double>> costs;
    for (const CameraId camera : cameras) {
        const auto images = images_of.find(camera);
        if (images == images_of.end()) continue;
        for (const Camera& lens : lenses)
            costs[camera].push_back(
                cost_with_lens(alone.model, camera, images->second, points, lens, options));
    }
    return costs;
}

Kinds compare_ties(const TiedModel& together, const TiedModel& apart, const ClusterProblem& problem,
                   const TieOptions& options) {
    std::map<CameraId, ReleasedCamera> released;
    for (const ClusterImage& image : problem.images) {
        const auto own = apart.costs.find(image.id);
        const auto tied = together.costs.find(image.id);
        if (own == apart.costs.end() || tied == together.costs.end() ||
            !problem.alike.contains(image.camera))
            continue;
        ReleasedCamera& camera = released[image.camera];
        camera.camera = image.camera;
        const auto focal_in = [&](const Reconstruction& model) {
            return model.cameras.at(model.find(image.id)->camera).mean_focal();
        };
        camera.tied_focal_px = focal_in(*together.model);
        camera.own_focal_px = focal_in(*apart.model);
        camera.tied_cost += tied->second.sum;
        camera.own_cost += own->second.sum;
        camera.observations += own->second.observations;
    }
    Kinds kinds;
    for (auto& [id, camera] : released) {
        camera.tied_cost /= static_cast<double>(camera.observations);
        camera.own_cost /= static_cast<double>(camera.observations);
        camera.deviates = deviates(camera, options);
        kinds[problem.alike.at(id)].push_back(camera);
    }
    return kinds;
}

bool any_deviates(const std::vector<ReleasedCamera>& kind) {
    return std::ranges::any_of(kind, &ReleasedCamera::deviates);
}

}  // namespace psfm
