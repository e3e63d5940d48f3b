// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/working_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>

#include "graph/camera_lens.h"
#include "stages/algorithms/math/in_parallel.h"

namespace psfm {
namespace {

constexpr std::size_t kPointsATask = 4096;  // Guard: of tasks too small to pay

}  // namespace

WorkingModel::WorkingModel(const ClusterProblem& problem, const CorrespondenceGraph& matches)
    : problem_(&problem),
      matches_(&matches),
      numbers_(problem),
      cameras_(problem.cameras),
      poses_(problem.images.size()) {
    point_of_.reserve(problem.images.size());
    for (const ClusterImage& image : problem.images) {
        point_of_.emplace_back(image.keypoints->size(), kNoPoint);
        visible_links_.emplace_back(image.keypoints->size(), std::uint16_t{0});
        const Camera& camera = cameras_.at(image.camera);
        pyramids_.emplace_back(camera.width, camera.height);
    }
}

bool WorkingModel::has_twin(CameraId id) const {
    return std::ranges::any_of(problem_->twins, [&](const auto& twin) {
        return (twin.first == id || twin.second == id) && cameras_.contains(twin.first) &&
               cameras_.contains(twin.second);
    });
}

void WorkingModel::share_lens(CameraId id) {
    if (problem_->twins.empty()) return;
    for (auto& [other, camera] : cameras_) {
        if (other != id && lens_of(other) == lens_of(id))
            camera = with_lens_of(camera, cameras_.at(id));
    }
}

void WorkingModel::load(const Reconstruction& model) {
    assert(registered_count_ == 0);
    for (const auto& [id, camera] : model.cameras) {
        if (const auto found = cameras_.find(id); found != cameras_.end()) found->second = camera;
    }
    for (const auto& [twin, camera] : problem_->twins) {
        if (!model.cameras.contains(camera) && model.cameras.contains(twin)) share_lens(twin);
    }
    append(model, Sim3());
}

void WorkingModel::append(const Reconstruction& model, const Sim3& cluster_from_model) {
    std::vector<bool> taken(image_count(), false);
    for (const RegisteredImage& image : model.images) {
        const auto local = numbers_.find(image.image);
        if (!local || registered(*local)) continue;
        taken[*local] = true;
        set_pose(*local, transform_pose(image.cam_from_cluster, cluster_from_model));
    }
    take_points(model.points, cluster_from_model, taken);
    // The images that are left see so much at once that counting anew is cheaper than following
    // every link.
    for (std::uint32_t image = 0; image < image_count(); ++image) {
        if (!registered(image)) count_visible(image);
    }
}

void WorkingModel::take_points(const ScenePoints& points, const Sim3& cluster_from_model,
                               const std::vector<bool>& taken) {
    const std::size_t before = points_.size();
    points_.resize(before + points.size());
    const auto take = [&](const ScenePoint& point, Point& loaded) {
        loaded.track.reserve(point.track.size());
        for (const Observation& observation : point.track) {
            const auto local = numbers_.find(observation.image);
            if (local && taken[*local]) loaded.track.push_back({*local, observation.feature});
        }
        std::ranges::sort(loaded.track);
        loaded.position = cluster_from_model * point.position;
        if (loaded.track.size() == point.track.size()) loaded.error_px = point.error_px;
    };
    in_parallel(points.blocks().size(), [&](std::size_t b) {
        std::size_t place = before + points.first_of(b);
        for (const ScenePoint& point : points.blocks()[b]->points()) take(point, points_[place++]);
    });
    const auto first = points_.begin() + static_cast<std::ptrdiff_t>(before);
    points_.erase(std::remove_if(first, points_.end(),
                                 [](const Point& point) { return point.track.size() < 2; }),
                  points_.end());
    alive_points_ += points_.size() - before;
    in_parallel(points_.size() - before, kPointsATask, [&](std::size_t i) {
        const auto point = static_cast<std::uint32_t>(before + i);
        for (const Feature& feature : points_[point].track)
            point_of_[feature.image][feature.feature] = point;
    });
}

double WorkingModel::mean_error(const Point& point) const {
    double error = 0.0;
    for (const Feature& feature : point.track)
        error += std::sqrt(squared_error(feature, point.position));
    return error / static_cast<double>(point.track.size());
}

Reconstruction WorkingModel::save() const {
    Reconstruction model;
    for (std::uint32_t image = 0; image < image_count(); ++image) {
        if (!registered(image)) continue;
        model.images.push_back({image_id(image), camera_id(image), pose(image)});
        model.cameras[camera_id(image)] = camera(image);
    }
    std::vector<const Point*> alive;
    alive.reserve(alive_points_);
    for (const Point& point : points_) {
        if (point.alive()) alive.push_back(&point);
    }
    std::vector<float> errors(alive.size());
    in_parallel(alive.size(), kPointsATask, [&](std::size_t p) {
        const Point& point = *alive[p];
        errors[p] = point.error_px ? *point.error_px : static_cast<float>(mean_error(point));
    });
    std::vector<std::size_t> kept;
    kept.reserve(alive.size());
    for (std::size_t p = 0; p < alive.size(); ++p) {
        if (std::isfinite(errors[p])) kept.push_back(p);
    }
    const auto saved = [&](std::size_t p) {
        ScenePoint result;
        result.position = alive[p]->position;
        result.error_px = errors[p];
        result.track.reserve(alive[p]->track.size());
        for (const Feature& feature : alive[p]->track)
            result.track.push_back({image_id(feature.image), feature.feature});
        return result;
    };
    constexpr std::size_t kBlock = ScenePoints::kBlockPoints;
    std::vector<PointBlockPtr> blocks((kept.size() + kBlock - 1) / kBlock);
    in_parallel(blocks.size(), [&](std::size_t b) {
        const std::size_t count = std::min(kBlock, kept.size() - b * kBlock);
        std::vector<ScenePoint> points;
        points.reserve(count);
        for (const std::size_t p : std::span(kept).subspan(b * kBlock, count))
            points.push_back(saved(p));
        blocks[b] = std::make_shared<const PointBlock>(std::move(points));
    });
    for (PointBlockPtr& block : blocks) model.points.append(std::move(block));
    return model;
}

void WorkingModel::set_pose(std::uint32_t image, const Rigid3& cam_from_cluster) {
    if (!poses_[image]) ++registered_count_;
    poses_[image] = cam_from_cluster;
}

void WorkingModel::remove_image(std::uint32_t image) {
    for (std::uint32_t feature = 0; feature < point_of_[image].size(); ++feature) {
        if (point_of_[image][feature] != kNoPoint) remove_observation({image, feature});
    }
    poses_[image].reset();
    --registered_count_;
    count_visible(image);
}

void WorkingModel::link(const Feature& feature, std::uint32_t point) {
    point_of_[feature.image][feature.feature] = point;
    for (const Feature& match : matches_->matches(feature)) {
        if (registered(match.image)) continue;
        if (visible_links_[match.image][match.feature]++ == 0)
            pyramids_[match.image].add(pixel(match));
    }
}

void WorkingModel::unlink(const Feature& feature) {
    point_of_[feature.image][feature.feature] = kNoPoint;
    for (const Feature& match : matches_->matches(feature)) {
        if (registered(match.image)) continue;
        if (--visible_links_[match.image][match.feature] == 0)
            pyramids_[match.image].remove(pixel(match));
    }
}

void WorkingModel::count_visible(std::uint32_t image) {
    const Camera& seen_by = camera(image);
    pyramids_[image] = VisibilityPyramid(seen_by.width, seen_by.height);
    for (std::uint32_t feature = 0; feature < visible_links_[image].size(); ++feature) {
        const auto& matches = matches_->matches({image, feature});
        const auto links = std::ranges::count_if(
            matches, [&](const Feature& match) { return point_of(match) != kNoPoint; });
        visible_links_[image][feature] = static_cast<std::uint16_t>(links);
        if (links > 0) pyramids_[image].add(pixel({image, feature}));
    }
}

std::uint32_t WorkingModel::add_point(const Eigen::Vector3d& position, std::vector<Feature> track) {
    assert(track.size() >= 2);
    std::ranges::sort(track);
    const auto point = static_cast<std::uint32_t>(points_.size());
    for (const Feature& feature : track) {
        assert(point_of(feature) == kNoPoint && registered(feature.image));
        link(feature, point);
    }
    points_.push_back({position, std::move(track)});
    ++alive_points_;
    return point;
}

bool WorkingModel::add_observation(std::uint32_t point, const Feature& feature) {
    assert(point_of(feature) == kNoPoint && registered(feature.image));
    std::vector<Feature>& track = points_[point].track;
    const auto place = std::ranges::lower_bound(track, Feature{feature.image, 0});
    if (place != track.end() && place->image == feature.image) return false;
    track.insert(place, feature);
    points_[point].error_px.reset();
    link(feature, point);
    return true;
}

void WorkingModel::remove_observation(const Feature& feature) {
    const std::uint32_t point = point_of(feature);
    assert(point != kNoPoint);
    if (points_[point].track.size() <= 2) {
        remove_point(point);
        return;
    }
    std::erase(points_[point].track, feature);
    points_[point].error_px.reset();
    unlink(feature);
}

void WorkingModel::remove_point(std::uint32_t point) {
    for (const Feature& feature : points_[point].track) unlink(feature);
    points_[point].track.clear();
    points_[point].track.shrink_to_fit();
    --alive_points_;
}

double WorkingModel::squared_error(const Feature& feature, const Eigen::Vector3d& position) const {
    const auto projected = project(camera(feature.image), pose(feature.image) * position);
    if (!projected) return std::numeric_limits<double>::infinity();
    return (*projected - pixel(feature)).squaredNorm();
}

}  // namespace psfm
