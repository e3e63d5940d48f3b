// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "graph/result.h"
#include "graph/rigid3.h"
#include "tests/synthetic/scene.h"

/// Scenes whose structure repeats, at the level of correspondences: what a matcher takes for one
/// point are several, at the same place of things that look alike. All matches follow from which
/// features an image has (look_alike_pairs.h): points are detected from a range of directions only,
/// as SIFT's are, and a copy from the same range as its original, so that matches become fewer with
/// distance in the same way around the truth and around each look-alike.
namespace psfm::synthetic {

/// The place of a point that has no copies.
inline constexpr std::uint32_t kNoPlace = std::numeric_limits<std::uint32_t>::max();

/// Invariants: looks and places are as long as scene.points; points of equal look have different
/// places; names are as long as scene.images, distinct, and ascending bytewise; order is a
/// permutation of the images.
struct LookAlikeScene {
    /// Keypoints carry the noise of the options; points are exact.
    SyntheticScene scene;
    /// What a point looks like: points of equal look are copies of one another. From 0, dense.
    std::vector<std::uint32_t> looks;
    std::uint32_t look_count = 0;
    /// The repeated thing that a point is on: an index into world_from_thing, or kNoPlace.
    std::vector<std::uint32_t> places;
    /// Where the repeated things stand. A point of place a has its copy of place b at
    /// world_from_thing[b] * inverse(world_from_thing[a]) * position.
    std::vector<Rigid3> world_from_thing;
    std::vector<std::string> names;
    /// An order of arrival that makes trouble (see the options of each scene).
    std::vector<std::size_t> order;
    /// Another one, district by district, the images of each in the order above: what an image
    /// overlaps does not become more with time. Empty but of streets.
    std::vector<std::size_t> order_by_district;
};

/// One ring of cameras around a round building of `symmetry` equal sides. Defaults: what SIFT's
/// matches say about temple-341 (measured: 1393, 574, 356, 150, 63 true matches at 1, 5, 10, 20
/// and 30 degrees apart, about 172 between images a side apart), fitted with least squares of
/// relative errors.
/// Names temple_0000.jpg, … in order of angle. Order: each image followed by its look-alike one
/// side further on.
struct TempleOptions {
    std::uint32_t images = 341;
    std::uint32_t symmetry = 6;  ///< equal sides; 1: nothing repeats
    /// Of an image's features, those that survive a change of view of mean `lasting_deg`, and those
    /// that survive less. Lengths are exponential, cut at max_deg.
    double lasting_features = 792.0, brief_features = 1261.0;
    double lasting_deg = 13.0, brief_deg = 1.6, max_deg = 50.0;
    /// Of the lasting features, the part that is the same on every side.
    double repeated_part = 0.223;
    double noise_px = 0.5;
};

/// A quadrangle; users walk along its four sides and look at the opposite one. The facades that
/// face one another across its length are equal in part.
/// Names user1_0000.jpg, …: in each user's order. Order: the users' images as they come in, the
/// users beginning at different times.
struct CourtyardOptions {
    std::uint32_t images = 600;
    std::uint32_t users = 8;
    double points_per_metre = 100.0;  ///< of facade
    double repeated_part = 0.4;       ///< of the points on the facades that repeat
    double noise_px = 0.5;
};

/// A town of square blocks. Users walk along its streets, a metre or so from image to image, and
/// look from one side over the front to the other. The town grows with the number of images, so
/// that the number of images that overlap one does not.
/// Names walk001_0000.jpg, …: in each user's order. Order: as in the courtyard.
struct StreetsOptions {
    std::uint32_t images = 10000;
    double points_per_metre = 300.0;  ///< of facade
    double copied_facades = 0.15;     ///< part of the facades that are copies of others
    double repeated_part = 0.5;       ///< of the points of a copied facade
    double noise_px = 0.5;
};

/// @errors kInvalidArgument
Result<void> validate(const TempleOptions& options);
Result<void> validate(const CourtyardOptions& options);
Result<void> validate(const StreetsOptions& options);

/// REQUIRES: validate(options). Deterministic for equal options and seed. Thread-safe.
/// Work and memory O(points + images * points near them); 10,000 images of streets take a minute
/// and 2 GB at most.
LookAlikeScene make_temple(const TempleOptions& options, std::uint64_t seed);
LookAlikeScene make_courtyard(const CourtyardOptions& options, std::uint64_t seed);
LookAlikeScene make_streets(const StreetsOptions& options, std::uint64_t seed);

}  // namespace psfm::synthetic
