// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/judge_ties.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "stages/algorithms/adjustment/reprojection_cost.h"
#include "stages/reconstruction/adjust/thin_points.h"
#include "stages/reconstruction/checks/judge_lenses.h"
#include "stages/reconstruction/checks/model_alone.h"

namespace psfm {
namespace {

struct Costs {
    double sum = 0.0;
    std::size_t observations = 0;
};

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

/// A model adjusted with given ties, and what is left of its observations' losses.
struct Adjusted {
    std::shared_ptr<const Reconstruction> model;  ///< null when that was not possible
    std::map<ImageId, Costs> costs;
};

/// @param coefficients  radial ones that lenses which are not given have at least
Adjusted adjusted(const std::shared_ptr<const Reconstruction>& model, const ClusterProblem& problem,
                  const CameraTies& ties, std::uint32_t coefficients, const TieOptions& options) {
    ModelAlone alone(model, problem, ties);
    WorkingModel& working = alone.model;
    if (coefficients > 1) give_second_coefficient(working);
    AdjustmentScope scope = full_scope(working, true);
    scope.points = covering_points(working, {}, options.points_per_image);
    const AdjustmentOptions adjustment{
        .loss_scale_px = 1.0, .max_iterations = options.max_iterations, .function_tolerance = 1e-4};
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

/// Each camera of a kind, by kind.
using Kinds = std::map<std::uint32_t, std::vector<ReleasedCamera>>;

Kinds compare(const Adjusted& together, const Adjusted& apart, const ClusterProblem& problem,
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

bool any_deviates(const Kinds::value_type& kind) {
    return std::ranges::any_of(kind.second, &ReleasedCamera::deviates);
}

/// Kinds that a better lens explains whole: none of theirs deviates.
void excuse(Kinds& kinds, const Kinds& with_better_lens) {
    for (const auto& kind : with_better_lens) {
        if (!any_deviates(kind)) kinds[kind.first] = kind.second;
    }
}

/// Where some of a kind deviate, all are sorted by focal length, and parted where these leave a
/// gap. Parts in which none deviates are one: what wanders and gains nothing stays together. Where
/// there is no gap, each stays by itself.
void part_by_focal(const std::vector<ReleasedCamera>& kind, double max_step,
                   std::map<CameraId, std::size_t>& labels, std::size_t& next) {
    std::vector<const ReleasedCamera*> sorted;
    sorted.reserve(kind.size());
    for (const ReleasedCamera& camera : kind) sorted.push_back(&camera);
    std::ranges::sort(
        sorted, {}, [](const ReleasedCamera* c) { return std::pair(c->own_focal_px, c->camera); });
    const auto follows = [&](const ReleasedCamera* before, const ReleasedCamera* camera) {
        return std::log(camera->own_focal_px / before->own_focal_px) < max_step;
    };
    for (auto first = sorted.begin(); first != sorted.end();) {
        auto last = std::next(first);
        while (last != sorted.end() && follows(*std::prev(last), *last)) ++last;
        const bool is_all = first == sorted.begin() && last == sorted.end();
        if (std::any_of(first, last, [](const ReleasedCamera* c) { return c->deviates; })) {
            ++next;
            for (auto camera = first; camera != last; ++camera)
                labels[(*camera)->camera] = is_all ? ++next : next;
        }
        first = last;
    }
}

/// Whether all of a kind are tied to one another.
bool tied_in(const CameraTies& ties, const std::vector<ReleasedCamera>& kind) {
    const auto labels = labels_of(ties);
    return std::ranges::all_of(kind, [&](const ReleasedCamera& camera) {
        return labels.at(camera.camera) == labels.at(kind.front().camera);
    });
}

/// The label that most of some cameras have; ties: the smallest.
std::size_t most_common(const std::vector<ReleasedCamera>& kind,
                        const std::map<CameraId, std::size_t>& labels) {
    std::map<std::size_t, std::size_t> counts;
    for (const ReleasedCamera& camera : kind) ++counts[labels.at(camera.camera)];
    return std::ranges::max_element(counts, {}, [](const auto& c) { return c.second; })->first;
}

}  // namespace

TieVerdict judge_ties(const std::shared_ptr<const Reconstruction>& model,
                      const ClusterProblem& problem, const CameraTies& ties,
                      const SolveOptions& options) {
    TieVerdict verdict{ties, model, {}};
    const CameraTies all = all_tied(problem);
    const Adjusted together = adjusted(model, problem, all, 1, options.ties);
    if (!together.model) return verdict;
    // What was tied differently is nearer to what each is by itself than what was bent together.
    const Adjusted apart =
        adjusted(ties == all ? together.model : model, problem, untied(problem), 1, options.ties);
    if (!apart.model) return verdict;
    auto kinds = compare(together, apart, problem, options.ties);
    if (options.ties.second_coefficient && std::ranges::any_of(kinds, any_deviates)) {
        const Adjusted with = adjusted(together.model, problem, all, 2, options.ties);
        if (with.model) excuse(kinds, compare(with, apart, problem, options.ties));
    }

    std::map<CameraId, std::size_t> labels = labels_of(all);
    std::size_t next = labels.size();
    bool any_leaves = false;
    for (const auto& [kind, cameras] : kinds) {
        verdict.released.insert(verdict.released.end(), cameras.begin(), cameras.end());
        if (std::ranges::none_of(cameras, &ReleasedCamera::deviates)) continue;
        any_leaves = true;
        // A model that was bent for one camera tells no focal lengths: what they are is asked of
        // one that was solved without.
        if (tied_in(ties, cameras)) {
            for (const ReleasedCamera& camera : cameras) labels[camera.camera] = ++next;
            continue;
        }
        part_by_focal(cameras, options.ties.max_step, labels, next);
        // What is not placed yet goes with most of them.
        const std::size_t most = most_common(cameras, labels);
        for (const auto& [id, of_kind] : problem.alike) {
            const bool is_placed = std::ranges::any_of(
                cameras, [&](const ReleasedCamera& camera) { return camera.camera == id; });
            if (of_kind == kind && !is_placed) labels[id] = most;
        }
    }
    verdict.ties = any_leaves ? ties_of(labels, problem) : all;
    verdict.model = with_ties(any_leaves ? apart.model : together.model, problem, verdict.ties);
    return verdict;
}

}  // namespace psfm
