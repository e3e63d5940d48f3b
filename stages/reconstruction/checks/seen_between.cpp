// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/seen_between.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/in_parallel.h"
#include "stages/algorithms/math/kd_tree.h"
#include "stages/algorithms/math/median.h"
#include "stages/reconstruction/checks/companions.h"

namespace psfm {
namespace {

/// A point with some of those who see it.
struct TrackedPoint {
    const ScenePoint* point = nullptr;
    std::vector<std::uint32_t> images;  ///< positions in the model
    std::vector<Eigen::Vector3d> rays;  ///< unit, from each of them
    double largest = 0.0;   ///< distance over focal length in the photograph with it at its largest
    double smallest = 0.0;  ///< and at its smallest
};

/// What an image has in front of it, in cells of the photograph, each with those around it.
class Foreground {
  public:
    Foreground() = default;
    Foreground(const Camera& camera, std::uint32_t grid)
        : cell_(static_cast<double>(std::max(camera.width, camera.height)) / grid),
          columns_(static_cast<std::uint32_t>(std::ceil(camera.width / cell_))),
          rows_(static_cast<std::uint32_t>(std::ceil(camera.height / cell_))),
          nearest_(std::size_t{columns_} * rows_, std::numeric_limits<double>::infinity()),
          points_(nearest_.size(), 0) {}

    void add(const Eigen::Vector2d& pixel, double depth) {
        const auto [column, row] = cell_of(pixel);
        for (std::uint32_t y = row - std::min(row, 1U); y < std::min(row + 2, rows_); ++y) {
            for (std::uint32_t x = column - std::min(column, 1U);
                 x < std::min(column + 2, columns_); ++x) {
                const std::size_t at = std::size_t{y} * columns_ + x;
                nearest_[at] = std::min(nearest_[at], depth);
                ++points_[at];
            }
        }
    }

    /// Whether what lies at a depth can be seen, among points that are.
    bool shows(const Eigen::Vector2d& pixel, double depth, const BetweenOptions& options) const {
        const auto [column, row] = cell_of(pixel);
        const std::size_t at = std::size_t{row} * columns_ + column;
        return points_[at] >= options.min_own && nearest_[at] >= options.min_depth * depth;
    }

  private:
    std::pair<std::uint32_t, std::uint32_t> cell_of(const Eigen::Vector2d& pixel) const {
        const auto along = [&](double at, std::uint32_t cells) {
            return std::min(static_cast<std::uint32_t>(std::max(at, 0.0) / cell_), cells - 1);
        };
        return {along(pixel.x(), columns_), along(pixel.y(), rows_)};
    }

    double cell_ = 1.0;
    std::uint32_t columns_ = 0;
    std::uint32_t rows_ = 0;
    std::vector<double> nearest_;
    std::vector<std::uint32_t> points_;
};

struct BetweenView {
    const RegisteredImage* image = nullptr;
    const Camera* camera = nullptr;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    std::vector<std::uint32_t> points;  ///< those it sees, of those that are looked at
    double median_depth = 0.0;          ///< 0: it has seen nothing
    Foreground foreground;
    std::vector<std::uint32_t> companions;
};

struct BetweenScene {
    std::vector<BetweenView> views;
    std::vector<TrackedPoint> points;
};

std::vector<BetweenView> views_of(const Reconstruction& model, const BetweenOptions& options) {
    std::vector<BetweenView> views(model.images.size());
    std::vector<std::vector<std::uint32_t>> companions = companions_of(model, options.companions);
    for (std::size_t i = 0; i < views.size(); ++i) {
        views[i].image = &model.images[i];
        views[i].camera = &model.cameras.at(model.images[i].camera);
        views[i].centre = model.images[i].cam_from_cluster.target_origin_in_source();
        views[i].foreground = Foreground(*views[i].camera, options.grid);
        views[i].companions = std::move(companions[i]);
    }
    return views;
}

/// Every so many-th point is enough for about so many of each image.
std::uint32_t step_of(const Reconstruction& model, std::uint32_t points_per_image) {
    if (points_per_image == 0) return 1;
    std::size_t observations = 0;
    for (const ScenePoint& point : model.points) observations += point.track.size();
    return static_cast<std::uint32_t>(
        std::max<std::size_t>(1, observations / (points_per_image * model.images.size())));
}

TrackedPoint tracked(const ScenePoint& point, const std::vector<std::uint32_t>& positions,
                     const std::vector<BetweenView>& views, const BetweenOptions& options) {
    TrackedPoint result{&point, {}, {}, std::numeric_limits<double>::infinity(), 0.0};
    const std::size_t length = point.track.size();
    const std::size_t asked = std::min<std::size_t>(length, options.max_track);
    result.images.reserve(asked);
    result.rays.reserve(asked);
    for (std::size_t k = 0; k < asked; ++k) {
        const std::uint32_t image = positions[index_of(point.track[k * length / asked].image)];
        const Eigen::Vector3d ray = point.position - views[image].centre;
        const double distance = ray.norm();
        result.images.push_back(image);
        result.rays.emplace_back(ray / distance);
        const double relative = distance / views[image].camera->mean_focal();
        result.largest = std::min(result.largest, relative);
        result.smallest = std::max(result.smallest, relative);
    }
    return result;
}

BetweenScene scene_of(const Reconstruction& model, std::uint32_t step,
                      const BetweenOptions& options) {
    BetweenScene scene;
    scene.views = views_of(model, options);
    const std::vector<std::uint32_t> positions = positions_by_id(model);
    std::vector<std::vector<double>> depths(scene.views.size());
    std::uint32_t number = 0;
    for (const ScenePoint& point : model.points) {
        for (const Observation& observation : point.track) {
            const std::uint32_t image = positions[index_of(observation.image)];
            BetweenView& view = scene.views[image];
            const Eigen::Vector3d in_camera = view.image->cam_from_cluster * point.position;
            depths[image].push_back(in_camera.z());
            if (const auto pixel = project(*view.camera, in_camera))
                view.foreground.add(*pixel, in_camera.z());
        }
        if (point.track.size() < options.min_track || number++ % step != step / 2) continue;
        const auto index = static_cast<std::uint32_t>(scene.points.size());
        scene.points.push_back(tracked(point, positions, scene.views, options));
        for (const Observation& observation : point.track)
            scene.views[positions[index_of(observation.image)]].points.push_back(index);
    }
    for (std::size_t i = 0; i < depths.size(); ++i) {
        if (!depths[i].empty())
            scene.views[i].median_depth = std::max(0.0, upper_median(std::move(depths[i])));
    }
    return scene;
}

/// The nearest images about one.
std::vector<std::uint32_t> near_images(std::uint32_t own, const std::vector<BetweenView>& views,
                                       const KdTree& centres, const BetweenOptions& options) {
    std::vector<std::pair<double, std::uint32_t>> near;
    const BetweenView& view = views[own];
    for (const std::uint32_t other :
         centres.nearer_than(view.centre, options.max_offset * view.median_depth)) {
        if (other != own) near.emplace_back((views[other].centre - view.centre).norm(), other);
    }
    std::ranges::sort(near);
    if (near.size() > options.max_neighbors) near.resize(options.max_neighbors);
    std::vector<std::uint32_t> images;
    images.reserve(near.size());
    for (const auto& [distance, other] : near) images.push_back(other);
    return images;
}

double angle_deg_between(const Eigen::Vector3d& one, const Eigen::Vector3d& other) {
    return kDegreesPerRadian * std::acos(std::clamp(one.dot(other), -1.0, 1.0));
}

/// Angles of an image's ray to those of a point's images; of the image itself none.
struct Angle {
    std::uint32_t entry = 0;  ///< of the track
    double degrees = 0.0;
};

bool lies_between(const std::vector<Angle>& angles, const TrackedPoint& point,
                  const BetweenOptions& options) {
    for (std::size_t a = 0; a < angles.size(); ++a) {
        for (std::size_t b = a + 1; b < angles.size(); ++b) {
            const double sum = angles[a].degrees + angles[b].degrees;
            if (sum > options.max_spread_deg + options.slack_deg) continue;
            const double spread =
                angle_deg_between(point.rays[angles[a].entry], point.rays[angles[b].entry]);
            if (sum <= spread + options.slack_deg && spread > options.min_spread_deg &&
                spread < options.max_spread_deg)
                return true;
        }
    }
    return false;
}

/// Whether an image has to see a point. @param angles  filled
bool has_to_see(std::uint32_t own, const BetweenView& view, const TrackedPoint& point,
                const BetweenOptions& options, std::vector<Angle>& angles) {
    const Eigen::Vector3d ray = point.point->position - view.centre;
    const double distance = ray.norm();
    const double relative = distance / view.camera->mean_focal();
    if (relative < (1.0 - options.size_slack) * point.largest ||
        relative > (1.0 + options.size_slack) * point.smallest)
        return false;
    const Eigen::Vector3d in_camera = view.image->cam_from_cluster * point.point->position;
    const auto pixel = project(*view.camera, in_camera);
    const Eigen::Array2d size(view.camera->width, view.camera->height);
    const double margin = options.margin * size.maxCoeff();
    if (!pixel || (pixel->array() < margin).any() || (pixel->array() > size - margin).any())
        return false;
    if (!view.foreground.shows(*pixel, in_camera.z(), options)) return false;
    angles.clear();
    for (std::uint32_t k = 0; k < point.images.size(); ++k) {
        if (point.images[k] != own)
            angles.push_back({k, angle_deg_between(ray / distance, point.rays[k])});
    }
    return lies_between(angles, point, options);
}

/// A point that an image has to see.
struct Expectation {
    std::uint32_t point = 0;
    bool is_seen = false;  ///< by it
};

/// What one image has to see, ascending.
std::vector<Expectation> expected_of(std::uint32_t own, const BetweenScene& scene,
                                     const std::vector<std::uint32_t>& near,
                                     const BetweenOptions& options) {
    const BetweenView& view = scene.views[own];
    std::vector<std::uint32_t> points = view.points;
    for (const std::uint32_t other : near) {
        const auto& theirs = scene.views[other].points;
        points.insert(points.end(), theirs.begin(), theirs.end());
    }
    std::ranges::sort(points);
    const auto repeated = std::ranges::unique(points);
    points.erase(repeated.begin(), repeated.end());
    std::vector<Expectation> expected;
    std::vector<Angle> angles;
    for (const std::uint32_t index : points) {
        const TrackedPoint& point = scene.points[index];
        if (has_to_see(own, view, point, options, angles))
            expected.push_back({index, point.point->is_seen_by(view.image->image)});
    }
    return expected;
}

/// Of all images, what each of them has to see.
using Expectations = std::vector<std::vector<Expectation>>;

const Expectation* find(const std::vector<Expectation>& expected, std::uint32_t point) {
    const auto found = std::ranges::lower_bound(expected, point, {}, &Expectation::point);
    return found == expected.end() || found->point != point ? nullptr : &*found;
}

/// Whether an image or a companion sees a point; nothing where too few of them have to.
std::optional<bool> is_seen_about(std::uint32_t own, const Expectation& expectation,
                                  const BetweenScene& scene, const Expectations& expected,
                                  const BetweenOptions& options) {
    const TrackedPoint& point = scene.points[expectation.point];
    bool is_seen = expectation.is_seen;
    const auto present = static_cast<std::uint32_t>(1 + scene.views[own].companions.size());
    std::uint32_t asked = 1;
    for (const std::uint32_t companion : scene.views[own].companions) {
        if (find(expected[companion], expectation.point) != nullptr) ++asked;
        is_seen |= point.point->is_seen_by(scene.views[companion].image->image);
    }
    if (asked < std::min(options.min_asked, present)) return std::nullopt;
    return is_seen;
}

/// Of one image and those that see what it has to: counted one way.
std::vector<SeenBetween> shared_with(std::uint32_t own, const BetweenScene& scene,
                                     const Expectations& expected, const BetweenOptions& options) {
    const double min_cosine = std::cos(radians_from_degrees(options.max_angle_deg));
    std::map<std::uint32_t, SeenBetween> with;
    for (const Expectation& expectation : expected[own]) {
        const auto is_seen = is_seen_about(own, expectation, scene, expected, options);
        if (!is_seen) continue;
        const TrackedPoint& point = scene.points[expectation.point];
        const Eigen::Vector3d ray = (point.point->position - scene.views[own].centre).normalized();
        for (std::size_t k = 0; k < point.images.size(); ++k) {
            const std::uint32_t other = point.images[k];
            if (other == own || point.rays[k].dot(ray) < min_cosine) continue;
            SeenBetween& pair = with[other];
            pair.first = std::min(own, other);
            pair.second = std::max(own, other);
            ++pair.expected;
            pair.shared += *is_seen ? 1 : 0;
        }
    }
    std::vector<SeenBetween> pairs;
    pairs.reserve(with.size());
    for (const auto& [other, pair] : with) pairs.push_back(pair);
    return pairs;
}

}  // namespace

std::vector<SeenBetween> find_seen_between(const Reconstruction& model,
                                           const BetweenOptions& options,
                                           std::uint32_t points_per_image) {
    if (model.images.empty()) return {};
    const std::uint32_t step = step_of(model, points_per_image);
    const BetweenScene scene = scene_of(model, step, options);
    std::vector<Eigen::Vector3d> centres;
    centres.reserve(scene.views.size());
    for (const BetweenView& view : scene.views) centres.push_back(view.centre);
    const KdTree tree(std::move(centres));
    Expectations expected(scene.views.size());
    in_parallel(expected.size(), [&](std::size_t i) {
        const auto own = static_cast<std::uint32_t>(i);
        expected[i] =
            expected_of(own, scene, near_images(own, scene.views, tree, options), options);
    });
    std::vector<std::vector<SeenBetween>> by_image(scene.views.size());
    in_parallel(by_image.size(), [&](std::size_t i) {
        by_image[i] = shared_with(static_cast<std::uint32_t>(i), scene, expected, options);
    });
    std::map<std::pair<std::uint32_t, std::uint32_t>, SeenBetween> both_ways;
    for (const std::vector<SeenBetween>& pairs : by_image) {
        for (const SeenBetween& pair : pairs) {
            SeenBetween& sum = both_ways[{pair.first, pair.second}];
            sum.first = pair.first;
            sum.second = pair.second;
            sum.expected += step * pair.expected;
            sum.shared += step * pair.shared;
        }
    }
    std::vector<SeenBetween> pairs;
    pairs.reserve(both_ways.size());
    for (const auto& [ends, pair] : both_ways) pairs.push_back(pair);
    return pairs;
}

}  // namespace psfm
