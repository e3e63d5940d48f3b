// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/photographs/photo_world.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "tests/synthetic/photographs/paint.h"
#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

/// A rectangle before it is painted.
struct Plan {
    PaintedRectangle rectangle;
    Paint paint = Paint::kPlaster;
    double texels_per_metre = 200.0;
};

PaintedRectangle rectangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& u, double width,
                           const Eigen::Vector3d& v, double height) {
    return {
        .corner = corner, .u_axis = u, .v_axis = v, .width = width, .height = height, .levels = {}};
}

struct Box {
    Eigen::Vector2d middle;
    double size_x = 1.0, size_y = 1.0;
    double bottom = 0.0, top = 1.0;
    double yaw = 0.0;  ///< [rad]
};

/// Four sides and the top; what stands on the ground shows no bottom.
void add_box(const Box& box, double texels_per_metre, Rng& rng, std::vector<Plan>& plans) {
    const Eigen::Vector3d x(std::cos(box.yaw), std::sin(box.yaw), 0.0);
    const Eigen::Vector3d y(-x.y(), x.x(), 0.0);
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d low = Eigen::Vector3d(box.middle.x(), box.middle.y(), box.bottom) -
                                0.5 * box.size_x * x - 0.5 * box.size_y * y;
    const Eigen::Vector3d far = low + box.size_x * x + box.size_y * y;
    const double height = box.top - box.bottom;
    const Paint paint = rng.below(3) == 0 ? Paint::kBricks : Paint::kPlaster;
    const auto add = [&](const PaintedRectangle& side) {
        plans.push_back({side, paint, texels_per_metre});
    };
    add(rectangle(low, x, box.size_x, up, height));
    add(rectangle(far, -x, box.size_x, up, height));
    add(rectangle(low + box.size_y * y, -y, box.size_y, up, height));
    add(rectangle(far - box.size_y * y, y, box.size_y, up, height));
    add(rectangle(low + height * up, x, box.size_x, y, box.size_y));
}

std::vector<Plan> plan_courtyard(double texels_per_metre, Rng& rng) {
    constexpr double kX = 9.0;
    constexpr double kY = 8.0;
    constexpr double kHeight = 5.0;
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
    const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    const double far = 0.5 * texels_per_metre;
    std::vector<Plan> plans;
    plans.push_back(
        {rectangle({-kX, -kY, 0}, x, 2 * kX, y, 2 * kY), Paint::kPaving, 0.8 * texels_per_metre});
    plans.push_back({rectangle({-kX, kY, 0}, x, 2 * kX, up, kHeight), Paint::kBricks, far});
    plans.push_back({rectangle({kX, -kY, 0}, -x, 2 * kX, up, kHeight), Paint::kPlaster, far});
    plans.push_back({rectangle({-kX, -kY, 0}, y, 2 * kY, up, kHeight), Paint::kBricks, far});
    plans.push_back({rectangle({kX, kY, 0}, -y, 2 * kY, up, kHeight), Paint::kPlaster, far});
    // In the middle a plinth with a turned box on it, about them boxes and pillars, against the
    // walls more.
    add_box({{0.0, 0.0}, 2.2, 1.8, 0.0, 1.1, 0.2}, texels_per_metre, rng, plans);
    add_box({{0.1, -0.1}, 1.3, 1.1, 1.1, 2.3, 0.8}, texels_per_metre, rng, plans);
    for (int i = 0; i < 7; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i + rng.uniform(-0.25, 0.25)) / 7.0;
        const double radius = rng.uniform(2.0, 3.0);
        const Eigen::Vector2d at = radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        const bool pillar = i % 3 == 0;
        const double size = pillar ? 0.4 : rng.uniform(0.5, 0.9);
        const double top = pillar ? rng.uniform(1.8, 2.6) : rng.uniform(0.4, 0.9);
        add_box({at, size, size * rng.uniform(0.8, 1.3), 0.0, top, rng.uniform(0.0, 1.5)},
                texels_per_metre, rng, plans);
    }
    for (int i = 0; i < 6; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i + rng.uniform(0.2, 0.8)) / 6.0;
        const Eigen::Vector2d at(7.9 * std::cos(angle), 7.0 * std::sin(angle));
        add_box({at, rng.uniform(0.7, 1.3), rng.uniform(0.7, 1.3), 0.0, rng.uniform(0.8, 3.0),
                 rng.uniform(0.0, 1.5)},
                0.6 * texels_per_metre, rng, plans);
    }
    return plans;
}

std::vector<Plan> plan_wall(double texels_per_metre, Rng& rng) {
    constexpr double kHalf = 6.0;
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    std::vector<Plan> plans;
    plans.push_back(
        {rectangle({-kHalf, 0, 0}, x, 2 * kHalf, up, 4.0), Paint::kBricks, texels_per_metre});
    plans.push_back({rectangle({-kHalf, -7, 0}, x, 2 * kHalf, Eigen::Vector3d::UnitY(), 7.0),
                     Paint::kPaving, texels_per_metre});
    for (int i = 0; i < 9; ++i) {
        const double at = -kHalf + 2.0 * kHalf * (i + rng.uniform(0.2, 0.8)) / 9.0;
        const double size = rng.uniform(0.3, 0.8);
        // Some stand before the wall, some hang on it.
        const double bottom = i % 2 == 0 ? 0.0 : rng.uniform(1.0, 2.0);
        add_box({{at, -rng.uniform(0.4, 1.2)},
                 size,
                 size,
                 bottom,
                 bottom + rng.uniform(0.5, 1.5),
                 rng.uniform(0.0, 1.5)},
                texels_per_metre, rng, plans);
    }
    return plans;
}

/// How brightly the sun and the sky light each part of a rectangle: a Lambertian surface with
/// soft-edged shadows, computed on a coarse grid.
cv::Mat1f light(const PhotoWorld& bare, const PaintedRectangle& rectangle, cv::Size texels) {
    constexpr int kCell = 4;
    cv::Mat1f coarse(texels.height / kCell, texels.width / kCell);
    const double lambert = std::max(0.0, rectangle.normal().dot(bare.to_sun));
    for (int y = 0; y < coarse.rows; ++y) {
        for (int x = 0; x < coarse.cols; ++x) {
            const double u = (x + 0.5) / coarse.cols * rectangle.width;
            const double v = (y + 0.5) / coarse.rows * rectangle.height;
            const Eigen::Vector3d position = rectangle.corner + u * rectangle.u_axis +
                                             v * rectangle.v_axis + 1e-4 * rectangle.normal();
            const bool lit = lambert > 0.0 && !cast_ray(bare, position, bare.to_sun);
            coarse(y, x) = static_cast<float>(0.7 + (lit ? 0.4 * lambert : 0.0));
        }
    }
    cv::Mat1f fine;
    cv::resize(coarse, fine, texels, 0, 0, cv::INTER_LINEAR);
    return fine;
}

/// Multiples of 64 texels: every level of the pyramid then halves exactly and stays aligned.
int texel_count(double metres, double texels_per_metre) {
    return 64 * std::max(1, static_cast<int>(std::ceil(metres * texels_per_metre / 64.0)));
}

std::vector<cv::Mat> paint_levels(const PhotoWorld& bare, const Plan& plan, std::uint64_t seed) {
    const PaintedRectangle& rectangle = plan.rectangle;
    const cv::Size texels(texel_count(rectangle.width, plan.texels_per_metre),
                          texel_count(rectangle.height, plan.texels_per_metre));
    cv::Mat3b image = paint_texture(texels, plan.texels_per_metre, plan.paint, seed);
    const cv::Mat1f brightness = light(bare, rectangle, texels);
    for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
            cv::Vec3b& texel = image(y, x);
            for (int i = 0; i < 3; ++i) {
                texel[i] = cv::saturate_cast<std::uint8_t>(static_cast<float>(texel[i]) *
                                                           brightness(y, x));
            }
        }
    }
    std::vector<cv::Mat> levels{image};
    while (levels.size() < 7) {
        cv::Mat half;
        cv::resize(levels.back(), half, {}, 0.5, 0.5, cv::INTER_AREA);
        levels.push_back(half);
    }
    return levels;
}

}  // namespace

std::optional<SurfaceHit> cast_ray(const PhotoWorld& world, const Eigen::Vector3d& origin,
                                   const Eigen::Vector3d& direction) {
    std::optional<SurfaceHit> nearest;
    for (std::uint32_t i = 0; i < world.rectangles.size(); ++i) {
        const PaintedRectangle& rectangle = world.rectangles[i];
        const Eigen::Vector3d normal = rectangle.normal();
        const double along = normal.dot(direction);
        const double height = normal.dot(origin - rectangle.corner);
        if (along >= 0.0 || height <= 0.0) continue;
        const double range = -height / along;
        if (nearest && range >= nearest->range) continue;
        const Eigen::Vector3d offset = origin + range * direction - rectangle.corner;
        const double u = offset.dot(rectangle.u_axis);
        const double v = offset.dot(rectangle.v_axis);
        if (u < 0.0 || v < 0.0 || u > rectangle.width || v > rectangle.height) continue;
        nearest = SurfaceHit{i, range, u, v, origin + range * direction};
    }
    return nearest;
}

PhotoWorld make_photo_world(PhotoScene scene, double texels_per_metre, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 41));
    const std::vector<Plan> plans = scene == PhotoScene::kCourtyard
                                        ? plan_courtyard(texels_per_metre, rng)
                                        : plan_wall(texels_per_metre, rng);
    PhotoWorld world;
    world.to_sun = scene == PhotoScene::kCourtyard ? Eigen::Vector3d(0.45, 0.3, 0.85).normalized()
                                                   : Eigen::Vector3d(0.4, -0.6, 0.7).normalized();
    for (const Plan& plan : plans) world.rectangles.push_back(plan.rectangle);
    const PhotoWorld bare = world;
    tbb::parallel_for(std::size_t{0}, plans.size(), [&](std::size_t i) {
        world.rectangles[i].levels = paint_levels(bare, plans[i], mix_seed(seed, 100 + i));
    });
    return world;
}

}  // namespace psfm::synthetic
