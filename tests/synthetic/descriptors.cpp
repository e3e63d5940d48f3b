// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/synthetic/rng.h"
#include "tests/synthetic/scene.h"

namespace psfm::synthetic {
namespace {

using Values = std::array<double, Descriptors::kSize>;

/// Histogram entries as SIFT's are: many small, few large.
Values random_histogram(std::uint64_t seed) {
    Rng rng(seed);
    Values values{};
    for (double& value : values) value = std::pow(rng.uniform(), 3.0);
    return values;
}

}  // namespace

Descriptors make_descriptors(const SyntheticScene& scene, ImageId image, double noise) {
    const SceneImage& view = scene.images.at(index_of(image));
    const std::uint64_t point_seed = mix_seed(scene.seed, 6);
    // From the pose, not the image's number: a renamed image keeps its descriptors.
    const Eigen::Vector3d centre = view.cam_from_world.target_origin_in_source();
    const std::uint64_t view_seed =
        mix_seed(point_seed, static_cast<std::uint64_t>(std::llround(1e9 * centre.x())) ^
                                 static_cast<std::uint64_t>(std::llround(1e9 * centre.y())) << 1U);
    Descriptors descriptors;
    descriptors.values.reserve(view.keypoints.size() * Descriptors::kSize);
    for (std::size_t i = 0; i < view.keypoints.size(); ++i) {
        const std::uint32_t point = view.feature_point[i];
        const bool clutter = point == kNoPoint;
        Values values =
            random_histogram(clutter ? mix_seed(view_seed, i) : mix_seed(point_seed, point));
        Rng rng(mix_seed(mix_seed(view_seed, 7), i));
        double sum = 0.0;
        for (double& value : values) {
            value = std::max(0.0, value + noise * rng.normal());
            sum += value;
        }
        for (const double value : values) {
            const double entry = std::round(512.0 * std::sqrt(value / std::max(sum, 1e-12)));
            descriptors.values.push_back(static_cast<std::uint8_t>(std::min(entry, 255.0)));
        }
    }
    return descriptors;
}

}  // namespace psfm::synthetic
