// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "graph/camera.h"
#include "graph/ids.h"
#include "graph/rigid3.h"
#include "graph/scene_points.h"

namespace psfm {

struct RegisteredImage {
    ImageId image{};
    CameraId camera{};
    Rigid3 cam_from_cluster;
};

/// Structure and motion of one cluster, in the cluster's own gauge.
/// Invariants: images ascending by id; every camera of an image is in cameras; points observe
/// registered images only; a feature belongs to at most one point.
struct Reconstruction {
    std::vector<RegisteredImage> images;
    std::map<CameraId, Camera> cameras;  ///< as refined by this cluster
    ScenePoints points;

    /// Binary search; nullptr when the image is not registered.
    const RegisteredImage* find(ImageId image) const;
    bool empty() const { return images.empty(); }
};

/// How a model followed from another one of its cluster, where most of it stayed as it was: the
/// points of `before` that are not replaced come first, in their order; all its images are there
/// still.
struct Succession {
    std::shared_ptr<const Reconstruction> before;
    std::vector<std::uint8_t> replaced;  ///< by point of `before`: 1 where it is not in the new one
};

/// How a model followed from an earlier one by way of one between.
/// REQUIRES: `later.before` is what `first` led to
Succession compose(const Succession& first, const Succession& later);

/// The part of a model that some images see: their poses, the cameras and points of these.
/// @param keep  ascending
Reconstruction restricted_to(const Reconstruction& model, std::span<const ImageId> keep);

/// Whether the model places an image that is not among `images` (ascending).
bool places_others_than(const Reconstruction& model, std::span<const ImageId> images);

}  // namespace psfm
