// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "graph/undistorted_view.h"
#include "storage/exchange/models/exported_model.h"

namespace psfm {

/// The picture that an image of a model has become.
struct DatasetImage {
    std::uint32_t view = 0;  ///< number in the list of views
    std::string name;        ///< the picture's file name
};

/// A model of pictures: pinhole cameras (ids are numbers of views plus one; only those in use),
/// poses turned as the pictures are, features moved to their undistorted places, the world shifted.
/// Images without a picture are left out, and with them points that fewer than two are left to see;
/// of points at one place, the first stays (distinct_points()). Ids of images and points stay.
/// @param images  one for each of the model's, in its order
/// @param origin  of the new world in the model's
/// Deterministic. Thread-safe.
ExportedModel dataset_model(const ExportedModel& model, std::span<const UndistortedView> views,
                            std::span<const std::optional<DatasetImage>> images,
                            const Eigen::Vector3d& origin);

/// A model's origin for readers that keep coordinates as 32-bit floats: zero where these do, else
/// the middle of the cameras in whole units. Floats keep seven digits, so what lies 100 times its
/// own size away keeps five of its own.
Eigen::Vector3d float_origin(const ExportedModel& model);

}  // namespace psfm
