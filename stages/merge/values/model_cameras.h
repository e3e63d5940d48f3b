// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "graph/reconstruction.h"
#include "stages/algorithms/math/kd_tree.h"

namespace psfm {

/// What merging asks of a model's cameras again and again, found once for as long as the model
/// stays. By image, as in Reconstruction::images; in the model's frame and units. Immutable, hence
/// thread-safe.
struct ModelCameras {
    std::vector<double> depths;          ///< mean_depths()
    std::vector<Eigen::Vector3d> ahead;  ///< optical axes
    KdTree centres;
    std::vector<double> neighbor_distances;  ///< to the nearest other centre; infinity: none
    /// A ball about all centres.
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double radius = 0.0;
    double largest_depth = 0.0;
};
using ModelCamerasPtr = std::shared_ptr<const ModelCameras>;

ModelCamerasPtr cameras_of(const Reconstruction& model);

/// How far away is what the images of a model see: a harmonic mean over some of the points, in the
/// model's units; 0 for an image that sees nothing. By image, as in Reconstruction::images.
std::vector<double> mean_depths(const Reconstruction& model);

}  // namespace psfm
