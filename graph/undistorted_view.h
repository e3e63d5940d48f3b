// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "graph/camera.h"
#include "graph/result.h"
#include "graph/rigid3.h"

namespace psfm {

/// How a picture without distortion is cut out of what a photograph shows.
struct UndistortedViewOptions {
    /// 0: every pixel of the picture is inside the photograph; 1: all of the photograph is in the
    /// picture, whose rest is black. Raised: more of the photograph, and black borders. Source:
    /// COLMAP 3.8's image_undistorter, blank_pixels 0.
    double blank_pixels = 0.0;
    /// Longer side of the picture at most [px]; 0: as the photograph has it. Lowered: less detail.
    std::uint32_t max_size = 0;
    /// Width and height are multiples of this, so that reduced copies are exact.
    std::uint32_t multiple = 1;
    /// The principal point is the picture's centre, as 3DGS's own trainer takes it to be; what a
    /// photograph has on one side more is cut off. Off: all of the photograph that fits.
    bool centred = true;

    bool operator==(const UndistortedViewOptions&) const = default;
};

/// A photograph's camera, and the pinhole camera whose picture is made of it.
struct UndistortedView {
    Camera photo;    ///< as the photograph is stored
    Camera picture;  ///< kPinhole, after the turn
    /// The picture is the photograph turned clockwise by so many quarters, 0 … 3.
    std::uint8_t quarter_turns = 0;

    bool operator==(const UndistortedView&) const = default;
};

/// @param quarter_turns  0 … 3
/// @errors kInvalidArgument: the options, or a camera whose distortion cannot be undone in any part
/// of its photographs worth the name
/// Deterministic. Thread-safe.
Result<UndistortedView> make_undistorted_view(const Camera& photo, std::uint8_t quarter_turns,
                                              const UndistortedViewOptions& options);

/// Clockwise quarter turns that bring a photograph's upper side up, by its EXIF orientation (1 … 8;
/// anything else counts as 1). A mirrored one (2, 4, 5, 7) is turned only: its mirror image is no
/// view of the world that the others show.
std::uint8_t upright_quarter_turns(std::uint8_t orientation);

/// Where in the photograph a place of the picture is [px].
Eigen::Vector2d photo_from_picture(const UndistortedView& view, const Eigen::Vector2d& picture);
/// Where in the picture a place of the photograph is [px], also outside of it.
Eigen::Vector2d picture_from_photo(const UndistortedView& view, const Eigen::Vector2d& photo);

/// The pose of the picture's camera.
Rigid3 turned_pose(const Rigid3& cam_from_world, std::uint8_t quarter_turns);

/// How far apart in the photograph the picture's places are at most, were they taken from it by
/// another camera [px]; infinite when photographs or turns differ in kind.
double largest_difference_px(const UndistortedView& view, const Camera& photo,
                             std::uint8_t quarter_turns);

/// Whether picture and photograph are the same pixels.
bool is_identity(const UndistortedView& view);

}  // namespace psfm
