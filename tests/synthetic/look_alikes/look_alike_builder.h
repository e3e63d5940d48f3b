// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/synthetic/look_alikes/look_alike_scene.h"

namespace psfm::synthetic {

/// Puts a LookAlikeScene together: cameras, places and images first, then points and who sees them.
/// Not thread-safe.
class LookAlikeBuilder {
  public:
    explicit LookAlikeBuilder(std::uint64_t seed);

    CameraId add_camera(const Camera& camera);
    std::uint32_t add_place(const Rigid3& world_from_thing);
    /// Images in ascending order of their names.
    ImageId add_image(CameraId camera, const Rigid3& cam_from_world, std::string name);
    std::uint32_t add_look() { return look_count_++; }
    /// @return index of the point, to be used with observe()
    std::uint32_t add_point(const SurfacePoint& point, std::uint32_t look, std::uint32_t place);

    /// Makes the point a feature of the image when it falls into it. Copies get blobs of equal size
    /// and colour. REQUIRES: not observed by this image before.
    void observe(ImageId image, std::uint32_t point);

    /// Points that no image sees are left out; features are sorted by scale, then disturbed by
    /// `noise_px`. The order of arrival is that of the names. The builder is empty afterwards.
    LookAlikeScene finish(double noise_px);

  private:
    std::uint64_t seed_;
    LookAlikeScene made_;
    std::uint32_t look_count_ = 0;
    std::vector<double> field_of_view_;  ///< of each camera, see scene_feature.h
};

/// The order in which the images of several users come in: users begin at random times within the
/// duration of the longest walk, and take an image about every second.
/// @param images_of_user  their images follow one another, user by user
/// The same images by stripes of the ground, along x, of so many images each (the last one's may
/// be fewer); those of a stripe as in `order`.
std::vector<std::size_t> order_by_stripe(const SyntheticScene& scene,
                                         const std::vector<std::size_t>& order,
                                         std::size_t images_of_stripe);

std::vector<std::size_t> interleaved_order(const std::vector<std::uint32_t>& images_of_user,
                                           std::uint64_t seed);

/// "prefix_0007.jpg": at least four digits, as many as `count` needs.
std::string image_name(const std::string& prefix, std::uint32_t index, std::uint32_t count);

}  // namespace psfm::synthetic
