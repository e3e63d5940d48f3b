// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <unordered_map>
#include <vector>

#include "graph/ids.h"
#include "graph/rigid3.h"
#include "graph/scene.h"
#include "graph/sim3.h"

namespace psfm {

/// A placed image in the frame of its component.
struct PlacedImage {
    ImageId image{};
    Rigid3 cam_from_component;
};

/// Where an image stood in the model that a session began with.
struct WorldAnchor {
    ImageId image{};
    Rigid3 cam_from_world;
};

/// Poses of all images in a published version; of the cluster with the smaller id where two hold
/// one image.
std::unordered_map<ImageId, Rigid3> published_poses(const Scene& scene);

/// Median distance of camera centres to their nearest other one; 0 for fewer than two. Of
/// thousands, some evenly chosen ones are asked.
double median_neighbor_distance(std::span<const Eigen::Vector3d> centres);

/// The similarity that leaves most images where they were published: robust, so that a part that
/// was moved for good reason (a loop closed, a cluster solved anew) does not drag the rest along.
/// Every image has one vote; of thousands, some evenly chosen ones.
/// @param images of one component
/// @param candidates similarities to be judged first, e.g. those that leave an unchanged cluster in
/// place
/// @param fallback the result where fewer than two images were published before and no candidate is
/// given
/// @param max_stayed_move see MergeOptions
Sim3 world_from_component(std::span<const PlacedImage> images,
                          const std::unordered_map<ImageId, Rigid3>& published,
                          std::span<const Sim3> candidates, const Sim3& fallback,
                          double max_stayed_move);

}  // namespace psfm
