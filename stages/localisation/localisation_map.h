// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "graph/camera.h"
#include "graph/image.h"
#include "graph/scene.h"
#include "stages/algorithms/matching/match_descriptors.h"

namespace psfm {

struct LocalisationMapOptions {
    /// Features of an image that it is recognised by: those of points, spread over all scales.
    /// Raised: slower, and more of the session in memory (128 bytes each); lowered: images of much
    /// detail are missed. Ours, chosen on quad-streams; no figure was kept.
    std::size_t features_per_image = 256;
};

/// A published model as localisation looks at it: points in the world, who sees them, and a sample
/// of each image's descriptors. Immutable once finished; then thread-safe.
class LocalisationMap {
  public:
    struct Point {
        Eigen::Vector3d in_world;
        std::uint32_t part = 0;  ///< its effective cluster
    };
    struct Place {
        Rigid3 cam_from_world;
        Camera camera;
        std::uint32_t part = 0;
    };

    /// @param scene  with points
    explicit LocalisationMap(const Scene& scene);

    /// Takes a sample of an image's descriptors. Not thread-safe.
    void add(ImageId image, const Descriptors& descriptors, const LocalisationMapOptions& options);
    /// After the last image.
    void finish();

    const std::map<ImageId, Place>& places() const { return places_; }
    const std::vector<Point>& points() const { return points_; }
    /// The point that a feature of an image observes.
    std::optional<std::uint32_t> point_of(ImageId image, std::uint32_t feature) const;

    /// How well each image goes with some descriptors: each votes, for all images that see the
    /// point of the sample's nearest descriptor.
    /// @param rows  descriptors of Descriptors::kSize bytes, one after another
    /// @return most votes first; images with a vote only
    struct Vote {
        ImageId image{};
        double votes = 0.0;
    };
    std::vector<Vote> vote(std::span<const std::uint8_t> rows) const;

    std::size_t sample_size() const { return sampled_points_.size(); }

  private:
    using Observations = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // feature, point

    std::map<ImageId, Place> places_;
    std::vector<Point> points_;
    std::map<ImageId, Observations> observations_;  // ascending by feature
    std::vector<std::vector<ImageId>> images_of_;   // by point
    Descriptors sample_;
    std::vector<std::uint32_t> sampled_points_;  // by row of the sample
    PackedDescriptors packed_;
};

}  // namespace psfm
