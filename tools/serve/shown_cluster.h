// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "graph/reconstruction.h"
#include "graph/sim3.h"

namespace psfm {

using Colour = std::array<std::uint8_t, 3>;

/// A point as watchers have it.
struct ShownPoint {
    std::uint64_t key = 0;     ///< of its first observation: shown_key
    Eigen::Vector3f position;  ///< in the shown frame
    Colour colour{};
    std::uint8_t error = 0;  ///< mean reprojection error, in steps of kErrorStepPx
    std::uint8_t track = 0;  ///< observations, at most 255
    std::uint32_t born = 0;  ///< images of the session when a second one had seen it
    bool there = false;

    static constexpr float kErrorStepPx = 0.02F;  // Format: 255 steps reach 5 px
};

/// A camera as watchers have it.
struct ShownPose {
    Eigen::Quaternionf cam_from_shown;
    Eigen::Vector3f centre;  ///< in the shown frame
    std::uint32_t camera = 0;
};

/// A cluster as watchers have it, in a frame of its own.
struct ShownCluster {
    std::shared_ptr<const Reconstruction> model;  ///< that points and poses were taken from
    ScenePoints followed;  ///< points that are shown; none: each has to be looked at anew
    std::uint32_t revision = 0;
    Sim3 cluster_from_shown;
    Sim3 world_from_shown;
    std::uint32_t part = 0;
    std::vector<ShownPoint> points;                          ///< by slot
    std::unordered_map<std::uint64_t, std::uint32_t> slots;  ///< by key, of those that are there
    std::map<ImageId, ShownPose> poses;
};

inline std::uint64_t shown_key(const Observation& first) {
    return (static_cast<std::uint64_t>(index_of(first.image)) << 32U) | first.feature;
}

/// Diagonal of the box around cameras and points, without the outermost of these.
double extent_of(const ShownCluster& shown);

/// Lets the shown frame follow the model's gauge, by the similarity that takes what is shown to
/// where the model has it; points that moved by themselves do not count.
/// @param most  half of what is shown may lie so far from where the model has it, in the shown
///              frame, until the frame follows
/// @return whether it is another frame now
bool fit_frame(ShownCluster& shown, const Reconstruction& model, double most);

/// target = similarity * source in the sense of least squares, with the worst left out; identity of
/// fewer than three pairs.
Sim3 robust_similarity(std::span<const std::pair<Eigen::Vector3d, Eigen::Vector3d>> source_target);

// The contents of parts of a change (docs/serve.md).
std::string place_content(const ShownCluster& shown);
std::string poses_content(const std::vector<std::pair<ImageId, ShownPose>>& poses);
/// Points put, or moved: in one box where they lie close together, and the far ones in another.
/// @param slots  ascending
std::vector<std::string> put_contents(const ShownCluster& shown,
                                      const std::vector<std::uint32_t>& slots);
std::vector<std::string> move_contents(ShownCluster& shown,
                                       const std::vector<std::uint32_t>& slots);

/// Makes points take the places that their bytes will say, in the order in which slots are given:
/// along a curve, near ones before far ones.
void sort_for_wire(std::vector<ShownPoint>& points);

}  // namespace psfm
