// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <memory>

#include "graph/reconstruction.h"
#include "stages/reconstruction/model/cluster_problem.h"

// Photographs without EXIF have a camera each, as accepted. Those that may well be of one camera
// (ClusterProblem::alike) are solved as if they were: their cameras are tied. Cameras of one size
// that are tied to one another have the smallest of their ids in the solve and in its model, so
// that a model tells what was tied in it, and no id means two cameras at once. Turned photographs
// are tied by their lens: the cameras of the two sizes stay two, equal but for the principal point.

namespace psfm {

struct CameraTies {
    /// What stands for each camera of a problem; itself where it is tied to none of its size.
    std::map<CameraId, CameraId> standing;
    /// As ClusterProblem::twins, among those that stand for others.
    std::map<CameraId, CameraId> twins;
    bool operator==(const CameraTies&) const = default;
};

/// Every camera by itself.
CameraTies untied(const ClusterProblem& problem);

/// All cameras of a kind tied to one another.
CameraTies all_tied(const ClusterProblem& problem);

/// Cameras with equal labels are tied.
CameraTies ties_of(const std::map<CameraId, std::size_t>& labels, const ClusterProblem& problem);

/// The contrary: cameras that are tied have equal labels, below the number of cameras.
std::map<CameraId, std::size_t> labels_of(const CameraTies& ties);

/// As the recycled models have it. What is new is tied to those of its kind that most images are
/// tied in; where no model has placed any, all of a kind are tied to one another; where models
/// have placed some, each with a camera of its own, what is new is not tied either.
CameraTies recycled_ties(const ClusterProblem& problem);

/// A model with its images' cameras tied as given. Where several cameras become one, it has the
/// middle one of their images' focal lengths; where one becomes several, each is a copy. Images
/// that are no members of the cluster stay as they are.
/// @return the model itself where nothing changes
std::shared_ptr<const Reconstruction> with_ties(const std::shared_ptr<const Reconstruction>& model,
                                                const ClusterProblem& problem,
                                                const CameraTies& ties);

/// The same problem, each image with the camera that stands for its own, recycled models too.
ClusterProblem tied(const ClusterProblem& problem, const CameraTies& ties);

}  // namespace psfm
