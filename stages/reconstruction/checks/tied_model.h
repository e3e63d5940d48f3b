// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "stages/reconstruction/checks/camera_ties.h"
#include "stages/reconstruction/model/tie_options.h"

namespace psfm {

/// Losses of observations.
struct Costs {
    double sum = 0.0;
    std::size_t observations = 0;
};

/// A model adjusted with given ties, and what is left of its observations' losses, by image.
struct TiedModel {
    std::shared_ptr<const Reconstruction> model;  ///< null when that was not possible
    std::map<ImageId, Costs> costs;
};

/// @param coefficients  radial ones that lenses which are not given have at least
TiedModel adjust_tied(const std::shared_ptr<const Reconstruction>& model,
                      const ClusterProblem& problem, const CameraTies& ties,
                      std::uint32_t coefficients, const TieOptions& options);

/// What the points that a camera's images see would cost if it had another lens. Its images are
/// taken out and placed anew by what others know of these points, since a pose that was found with
/// a wrong lens, and points that were seen from it, do not let go of each other; then they are
/// adjusted with the points, all other images as they are.
/// @param cameras  as accepted
/// @return by camera, as `lenses`; infinity where its images find no place with such a lens
std::map<CameraId, std::vector<double>> costs_by_lens(
    const std::shared_ptr<const Reconstruction>& model, const ClusterProblem& problem,
    std::span<const CameraId> cameras, std::span<const Camera> lenses, const TieOptions& options);

/// A camera adjusted together with all of its kind, and by itself.
struct ReleasedCamera {
    CameraId camera{};  ///< as accepted
    double tied_focal_px = 0.0, own_focal_px = 0.0;
    double tied_cost = 0.0, own_cost = 0.0;  ///< mean loss of its observations
    std::size_t observations = 0;
    bool deviates = false;  ///< it is not the camera of the others
};

/// Each camera of a kind, ascending, by kind.
using Kinds = std::map<std::uint32_t, std::vector<ReleasedCamera>>;

/// Compares the cameras of two models of the same images.
Kinds compare_ties(const TiedModel& together, const TiedModel& apart, const ClusterProblem& problem,
                   const TieOptions& options);

bool any_deviates(const std::vector<ReleasedCamera>& kind);

}  // namespace psfm
