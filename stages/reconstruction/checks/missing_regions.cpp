// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/missing_regions.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/in_parallel.h"
#include "stages/reconstruction/checks/companions.h"

namespace psfm {
namespace {

/// A point as an image sees it.
struct SeenPoint {
    const ScenePoint* point = nullptr;
    std::uint32_t region = 0;
    double depth = 0.0;
    double distance = 0.0;
};

struct RegionView {
    const RegisteredImage* image = nullptr;
    const Camera* camera = nullptr;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    std::vector<SeenPoint> seen;
    std::vector<ImageId> companions;
};

/// What is expected of one image in the regions of another, and found there.
struct Region {
    std::uint32_t expected = 0;
    std::uint32_t shared = 0;  ///< with it or one of its companions
    std::uint32_t own = 0;     ///< points of the other image there that are not nearer
    double depth = 0.0;        ///< of the expected ones, their mean
};

std::uint32_t region_of(const Eigen::Vector2d& pixel, const Camera& camera, std::uint32_t grid) {
    const auto along = [&](double at, double size) {
        const double part = std::clamp(at / size, 0.0, 1.0);
        return std::min(static_cast<std::uint32_t>(part * grid), grid - 1);
    };
    return along(pixel.y(), camera.height) * grid + along(pixel.x(), camera.width);
}

std::vector<RegionView> region_views_of(const Reconstruction& model, const DoubtOptions& options) {
    std::vector<RegionView> views(model.images.size());
    const std::vector<std::vector<std::uint32_t>> companions =
        companions_of(model, options.companions);
    for (std::uint32_t i = 0; i < model.images.size(); ++i) {
        const RegisteredImage& image = model.images[i];
        views[i].image = &image;
        views[i].camera = &model.cameras.at(image.camera);
        views[i].centre = image.cam_from_cluster.target_origin_in_source();
        for (const std::uint32_t companion : companions[i])
            views[i].companions.push_back(model.images[companion].image);
    }
    const std::vector<std::uint32_t> position_of = positions_by_id(model);
    for (const ScenePoint& point : model.points) {
        if (point.track.size() < options.min_track) continue;
        for (const Observation& observation : point.track) {
            RegionView& view = views[position_of[index_of(observation.image)]];
            const Eigen::Vector3d in_camera = view.image->cam_from_cluster * point.position;
            const auto pixel = project(*view.camera, in_camera);
            if (!pixel) continue;
            view.seen.push_back({&point, region_of(*pixel, *view.camera, options.grid),
                                 in_camera.z(), (point.position - view.centre).norm()});
        }
    }
    return views;
}

/// Whether an image sees a point of another one, or one of its companions does.
bool is_shared(const SeenPoint& seen, const RegionView& one, const RegionView& other) {
    const ScenePoint& point = *seen.point;
    return point.is_seen_by(other.image->image) ||
           std::ranges::any_of(other.companions, [&](ImageId companion) {
               return companion != one.image->image && point.is_seen_by(companion);
           });
}

/// What `one` has seen, in the regions of `other`.
std::vector<Region> expect(const RegionView& one, const RegionView& other,
                           const DoubtOptions& options) {
    std::vector<Region> regions(std::size_t{options.grid} * options.grid);
    const double min_cosine = std::cos(radians_from_degrees(options.max_angle_deg));
    const double focal = other.camera->mean_focal() / one.camera->mean_focal();
    const Eigen::Array2d size(other.camera->width, other.camera->height);
    for (const SeenPoint& seen : one.seen) {
        const Eigen::Vector3d ray = seen.point->position - other.centre;
        const double distance = ray.norm();
        const double scale = seen.distance / distance * focal;
        if (std::max(scale, 1.0 / scale) > options.max_scale) continue;
        const double cosine =
            (seen.point->position - one.centre).dot(ray) / (seen.distance * distance);
        if (cosine < min_cosine) continue;
        const Eigen::Vector3d in_camera = other.image->cam_from_cluster * seen.point->position;
        const auto pixel = project(*other.camera, in_camera);
        if (!pixel || (pixel->array() < 0.0).any() || (pixel->array() >= size).any()) continue;
        Region& region = regions[region_of(*pixel, *other.camera, options.grid)];
        ++region.expected;
        region.depth += in_camera.z();
        if (is_shared(seen, one, other)) ++region.shared;
    }
    for (Region& region : regions) region.depth /= std::max(1U, region.expected);
    for (const SeenPoint& own : other.seen) {
        Region& region = regions[own.region];
        if (own.depth >= options.min_depth * region.depth) ++region.own;
    }
    return regions;
}

ComparedPair compare_regions(const std::vector<RegionView>& views, std::uint32_t first,
                             std::uint32_t second, const DoubtOptions& options) {
    ComparedPair pair{first, second, 0, 0};
    std::vector<Region> regions = expect(views[first], views[second], options);
    const std::vector<Region> back = expect(views[second], views[first], options);
    regions.insert(regions.end(), back.begin(), back.end());
    std::uint32_t expected = 0;
    std::uint32_t shared = 0;
    std::uint32_t expected_where_shared = 0;
    for (const Region& region : regions) {
        expected += region.expected;
        shared += region.shared;
        if (region.shared > 0) expected_where_shared += region.expected;
    }
    if (expected < options.min_points) return pair;
    const double rate = shared < options.few_shared
                            ? options.unknown_rate
                            : static_cast<double>(shared) / expected_where_shared;
    for (const Region& region : regions) {
        if (region.expected * rate < options.min_expected) continue;
        ++pair.regions;
        if (region.shared == 0 && region.own >= options.min_own) ++pair.missing;
    }
    return pair;
}

}  // namespace

std::vector<ComparedPair> compare_by_region(const Reconstruction& model,
                                            const DoubtOptions& options) {
    const std::vector<RegionView> views = region_views_of(model, options);
    std::vector<ComparedPair> pairs;
    for (std::uint32_t i = 0; i < views.size(); ++i) {
        for (std::uint32_t j = i + 1; j < views.size(); ++j) pairs.push_back({i, j, 0, 0});
    }
    in_parallel(pairs.size(), 8, [&](std::size_t k) {
        pairs[k] = compare_regions(views, pairs[k].first, pairs[k].second, options);
    });
    std::erase_if(pairs, [](const ComparedPair& pair) { return pair.regions == 0; });
    return pairs;
}

bool contradicts(const ComparedPair& pair, const DoubtOptions& options) {
    return pair.missing >= options.min_missing &&
           pair.missing >= options.min_missing_part * pair.regions;
}

}  // namespace psfm
