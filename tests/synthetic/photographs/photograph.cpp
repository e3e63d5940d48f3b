// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/photographs/photograph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

constexpr std::uint16_t kSky = std::numeric_limits<std::uint16_t>::max();

/// What a ray sees: a rectangle and the place on it [texels of level 0].
struct Sight {
    std::uint16_t rectangle = kSky;
    Eigen::Vector2f texel = Eigen::Vector2f::Zero();
    float range = 0.F;  ///< [m] along the optical axis
};

/// A rectangle that faces the camera, with what is the same for all rays of one photograph. With
/// rays of unit depth, range = 1 / (depth . ray), and the texel is range * (u . ray, v . ray).
struct FacingRectangle {
    std::uint16_t index = 0;
    Eigen::Vector3f depth;
    Eigen::Vector3f u, v;            ///< in the camera's frame [texels / m]
    Eigen::Vector2f offset, extent;  ///< [texels]
};

std::vector<FacingRectangle> facing(const PhotoWorld& world, const Rigid3& cam_from_world) {
    std::vector<FacingRectangle> result;
    const Eigen::Vector3d centre = cam_from_world.target_origin_in_source();
    for (std::size_t i = 0; i < world.rectangles.size(); ++i) {
        const PaintedRectangle& rectangle = world.rectangles[i];
        const Eigen::Vector3d to_corner = rectangle.corner - centre;
        const double distance = to_corner.dot(rectangle.normal());
        if (distance >= 0.0) continue;
        const cv::Mat& image = rectangle.levels.front();
        const double per_u = image.cols / rectangle.width;
        const double per_v = image.rows / rectangle.height;
        FacingRectangle entry;
        entry.index = static_cast<std::uint16_t>(i);
        const Eigen::Vector3d depth = cam_from_world.rotation * rectangle.normal() / distance;
        const Eigen::Vector3d u = cam_from_world.rotation * rectangle.u_axis * per_u;
        const Eigen::Vector3d v = cam_from_world.rotation * rectangle.v_axis * per_v;
        entry.depth = depth.cast<float>();
        entry.u = u.cast<float>();
        entry.v = v.cast<float>();
        entry.offset = -Eigen::Vector2d(to_corner.dot(rectangle.u_axis) * per_u,
                                        to_corner.dot(rectangle.v_axis) * per_v)
                            .cast<float>();
        entry.extent = {static_cast<float>(image.cols), static_cast<float>(image.rows)};
        result.push_back(entry);
    }
    return result;
}

Sight look(const std::vector<FacingRectangle>& rectangles, const Eigen::Vector2f& normalized) {
    const Eigen::Vector3f ray(normalized.x(), normalized.y(), 1.F);
    Sight nearest;
    float nearness = 0.F;  // 1 / range of the nearest so far
    for (const FacingRectangle& rectangle : rectangles) {
        const float near = rectangle.depth.dot(ray);
        if (near <= nearness) continue;
        const float range = 1.F / near;
        const Eigen::Vector2f texel =
            range * Eigen::Vector2f(rectangle.u.dot(ray), rectangle.v.dot(ray)) + rectangle.offset;
        if (texel.x() < 0.F || texel.y() < 0.F || texel.x() > rectangle.extent.x() ||
            texel.y() > rectangle.extent.y()) {
            continue;
        }
        nearness = near;
        nearest = {rectangle.index, texel, range};
    }
    return nearest;
}

/// Bilinear; texel (i, j) has its centre at (i + 0.5, j + 0.5); the border repeats.
Eigen::Vector3f bilinear(const cv::Mat& image, float x, float y) {
    const float left = std::floor(x - 0.5F);
    const float top = std::floor(y - 0.5F);
    const float fx = x - 0.5F - left;
    const float fy = y - 0.5F - top;
    const auto colour = [&](float column, float row) {
        const int i = std::clamp(static_cast<int>(column), 0, image.cols - 1);
        const int j = std::clamp(static_cast<int>(row), 0, image.rows - 1);
        const std::uint8_t* bgr = image.ptr<std::uint8_t>(j) + 3 * i;
        return Eigen::Vector3f(bgr[0], bgr[1], bgr[2]);
    };
    const Eigen::Vector3f above = (1.F - fx) * colour(left, top) + fx * colour(left + 1.F, top);
    const Eigen::Vector3f below =
        (1.F - fx) * colour(left, top + 1.F) + fx * colour(left + 1.F, top + 1.F);
    return (1.F - fy) * above + fy * below;
}

/// @param footprint width of what the sample stands for [texels of level 0]
Eigen::Vector3f trilinear(const std::vector<cv::Mat>& levels, const Eigen::Vector2f& texel,
                          float footprint) {
    const float last = static_cast<float>(levels.size() - 1);
    const float level = std::clamp(std::log2(std::max(footprint, 1e-6F)), 0.F, last);
    const auto lower = static_cast<std::size_t>(level);
    const float part = level - static_cast<float>(lower);
    const float scale = 1.F / static_cast<float>(1U << lower);
    const Eigen::Vector3f fine = bilinear(levels[lower], texel.x() * scale, texel.y() * scale);
    if (part < 0.01F) return fine;
    const Eigen::Vector3f coarse =
        bilinear(levels[lower + 1], 0.5F * texel.x() * scale, 0.5F * texel.y() * scale);
    return (1.F - part) * fine + part * coarse;
}

/// Brighter towards the horizon; without any detail, as a clear sky is.
Eigen::Vector3f sky(const Eigen::Vector3f& up_in_cam, const Eigen::Vector2f& normalized) {
    const Eigen::Vector3f ray = normalized.homogeneous().normalized();
    const float height = std::clamp(ray.dot(up_in_cam), 0.F, 1.F);
    return Eigen::Vector3f(245.F, 235.F, 225.F) - height * Eigen::Vector3f(20.F, 60.F, 90.F);
}

/// One photograph under way.
class Exposure {
  public:
    Exposure(const PhotoWorld& world, const SightLines& sight, const Rigid3& cam_from_world)
        : world_(world),
          sight_(sight),
          facing_(facing(world, cam_from_world)),
          up_in_cam_((cam_from_world.rotation * Eigen::Vector3d::UnitZ()).cast<float>()) {}

    /// Sights of the corners above pixel row y.
    std::vector<Sight> corner_row(std::uint32_t y) const {
        std::vector<Sight> row(sight_.camera.width + 1);
        for (std::uint32_t x = 0; x < row.size(); ++x) row[x] = look(facing_, sight_.at(x, y));
        return row;
    }

    /// @param corners left above, right above, left below, right below
    Eigen::Vector3f pixel(std::uint32_t x, std::uint32_t y,
                          const std::array<Sight, 4>& corners) const {
        const bool one_surface = std::ranges::all_of(
            corners, [&](const Sight& sight) { return sight.rectangle == corners[0].rectangle; });
        if (!one_surface) return edge_pixel(x, y);
        if (corners[0].rectangle == kSky) return sky(up_in_cam_, sight_.at(x, y));
        return inner_pixel(corners);
    }

  private:
    /// All of one rectangle: places on it are interpolated between the corners (good to 1e-3
    /// texels), and four samples are averaged.
    Eigen::Vector3f inner_pixel(const std::array<Sight, 4>& corners) const {
        const auto& [a, b, c, d] = corners;
        const float step_x = (b.texel - a.texel).norm();
        const float step_y = (c.texel - a.texel).norm();
        // Half a pixel a sample. Where the surface is seen at a slant, between the long and the
        // short side.
        const float footprint =
            0.5F * (0.7F * std::max(step_x, step_y) + 0.3F * std::min(step_x, step_y));
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (const float fy : {0.25F, 0.75F}) {
            for (const float fx : {0.25F, 0.75F}) {
                const Eigen::Vector2f texel = (1.F - fy) * ((1.F - fx) * a.texel + fx * b.texel) +
                                              fy * ((1.F - fx) * c.texel + fx * d.texel);
                sum += trilinear(world_.rectangles[a.rectangle].levels, texel, footprint);
            }
        }
        return 0.25F * sum;
    }

    /// On an outline: sixteen rays of their own.
    Eigen::Vector3f edge_pixel(std::uint32_t x, std::uint32_t y) const {
        constexpr int kSamples = 4;
        const float f = static_cast<float>(sight_.camera.mean_focal());
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (int j = 0; j < kSamples; ++j) {
            for (int i = 0; i < kSamples; ++i) {
                const float fx = (static_cast<float>(i) + 0.5F) / kSamples;
                const float fy = (static_cast<float>(j) + 0.5F) / kSamples;
                const Eigen::Vector2f normalized =
                    (1.F - fy) * ((1.F - fx) * sight_.at(x, y) + fx * sight_.at(x + 1, y)) +
                    fy * ((1.F - fx) * sight_.at(x, y + 1) + fx * sight_.at(x + 1, y + 1));
                const Sight seen = look(facing_, normalized);
                if (seen.rectangle == kSky) {
                    sum += sky(up_in_cam_, normalized);
                    continue;
                }
                const PaintedRectangle& rectangle = world_.rectangles[seen.rectangle];
                const auto texels = static_cast<float>(rectangle.texels_per_metre());
                sum += trilinear(rectangle.levels, seen.texel, texels * seen.range / f / kSamples);
            }
        }
        return sum / (kSamples * kSamples);
    }

    const PhotoWorld& world_;
    const SightLines& sight_;
    std::vector<FacingRectangle> facing_;
    Eigen::Vector3f up_in_cam_;
};

/// Normal numbers to draw from: 64 thousand of them are as good as millions, and much faster.
std::vector<float> noise_table(double sigma, Rng& rng) {
    std::vector<float> table(1U << 16U);
    for (float& value : table) value = static_cast<float>(sigma * rng.normal());
    return table;
}

}  // namespace

SightLines make_sight_lines(const Camera& camera) {
    SightLines lines{.camera = camera, .normalized = {}};
    lines.normalized.reserve((camera.width + std::size_t{1}) * (camera.height + std::size_t{1}));
    for (std::uint32_t y = 0; y <= camera.height; ++y) {
        for (std::uint32_t x = 0; x <= camera.width; ++x) {
            lines.normalized.push_back(
                normalized_from_pixel(camera, {static_cast<double>(x), static_cast<double>(y)})
                    .cast<float>());
        }
    }
    return lines;
}

cv::Mat take_photograph(const PhotoWorld& world, const SightLines& sight,
                        const Rigid3& cam_from_world, const PhotographOptions& options,
                        std::uint64_t seed) {
    const auto width = sight.camera.width;
    const auto height = sight.camera.height;
    Rng rng(mix_seed(seed, 42));
    const double exposure = 1.0 + options.exposure_sigma * rng.normal();
    const std::vector<float> noise = noise_table(options.noise_sigma, rng);
    const Exposure shot(world, sight, cam_from_world);
    const double corner = std::hypot(0.5 * width, 0.5 * height);
    cv::Mat3b image(static_cast<int>(height), static_cast<int>(width));
    std::vector<Sight> above = shot.corner_row(0);
    for (std::uint32_t y = 0; y < height; ++y) {
        std::vector<Sight> below = shot.corner_row(y + 1);
        cv::Vec3b* row = image[static_cast<int>(y)];
        for (std::uint32_t x = 0; x < width; ++x) {
            const Eigen::Vector3f colour =
                shot.pixel(x, y, {above[x], above[x + 1], below[x], below[x + 1]});
            const double dx = (x + 0.5 - 0.5 * width) / corner;
            const double dy = (y + 0.5 - 0.5 * height) / corner;
            const auto gain = static_cast<float>(
                exposure * (1.0 - options.corner_darkening * (dx * dx + dy * dy)));
            const std::uint64_t random = rng.bits();
            for (int i = 0; i < 3; ++i) {
                const float grain = noise[(random >> (16 * i)) & 0xffffU];
                row[x][i] = cv::saturate_cast<std::uint8_t>(gain * colour[i] + grain);
            }
        }
        above = std::move(below);
    }
    return image;
}

}  // namespace psfm::synthetic
