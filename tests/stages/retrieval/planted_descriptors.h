// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "graph/image.h"
#include "stages/retrieval/retrieval_state.h"
#include "tests/synthetic/rng.h"

namespace psfm::synthetic {

/// Descriptors of scene points, unrelated to each other: most bytes small, some large, as SIFT's
/// are.
inline Descriptors random_points(std::size_t count, std::uint64_t seed) {
    Rng rng(seed);
    Descriptors points;
    points.values.resize(count * Descriptors::kSize);
    for (std::uint8_t& value : points.values) {
        const double u = rng.uniform();
        value = static_cast<std::uint8_t>(160.0 * u * u * u);
    }
    return points;
}

/// Points [begin, end) of a circular scene, as one image sees them: each byte off by up to `noise`.
inline Descriptors view_of(const Descriptors& points, std::size_t begin, std::size_t end, int noise,
                           std::uint64_t seed) {
    Rng rng(seed);
    Descriptors view;
    for (std::size_t i = begin; i < end; ++i) {
        const std::uint8_t* row = points.row(i % points.rows());
        for (std::size_t k = 0; k < Descriptors::kSize; ++k) {
            const int offset =
                static_cast<int>(rng.below(static_cast<std::size_t>(2 * noise) + 1)) - noise;
            view.values.push_back(static_cast<std::uint8_t>(std::clamp(row[k] + offset, 0, 255)));
        }
    }
    return view;
}

/// Images on a ring, in random order of arrival: image at place p sees points [p * step, p * step +
/// features).
struct Ring {
    std::vector<std::shared_ptr<const Descriptors>> images;
    std::vector<std::size_t> places;  ///< of each image, by order of arrival

    Ring(std::size_t count, std::size_t features, std::size_t step, std::uint64_t seed)
        : places(random_order(count, seed)) {
        const Descriptors points = random_points(count * step, seed + 1);
        for (const std::size_t place : places) {
            images.push_back(std::make_shared<const Descriptors>(
                view_of(points, place * step, place * step + features, 6, seed + 2 + place)));
        }
    }
    DescriptorSource source() const {
        return [this](ImageId id) -> Result<std::shared_ptr<const Descriptors>> {
            return images.at(index_of(id));
        };
    }
    /// Steps along the ring between two images, by order of arrival.
    std::size_t distance(std::size_t a, std::size_t b) const {
        const std::size_t d = places[a] > places[b] ? places[a] - places[b] : places[b] - places[a];
        return std::min(d, places.size() - d);
    }
};

}  // namespace psfm::synthetic
