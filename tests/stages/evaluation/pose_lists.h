// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Lists of named poses that the evaluation tests plant truth in.

#include <numbers>
#include <string>
#include <vector>

#include "graph/sim3.h"
#include "stages/evaluation/named_pose.h"
#include "tests/synthetic/rng.h"

namespace psfm::test {

inline constexpr double kRadians = std::numbers::pi / 180.0;

inline NamedPose pose_at(std::string name, const Eigen::Vector3d& centre,
                         const Eigen::Quaterniond& rotation) {
    return {std::move(name), {rotation, -(rotation * centre)}};
}

/// "00007.jpg": names in the order of the numbers. REQUIRES: i < 100000
inline std::string numbered_name(std::size_t i) {
    return std::to_string(100000 + i).substr(1) + ".jpg";
}

/// Cameras on a grid of 1 m with jitter below 0.2 m, randomly turned: no two closer than 0.6 m.
inline std::vector<NamedPose> grid_poses(std::size_t count, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    std::vector<NamedPose> poses;
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Vector3d cell(static_cast<double>(i % 7), static_cast<double>(i / 7 % 5),
                                   static_cast<double>(i / 35));
        const Eigen::Vector3d jitter(rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2),
                                     rng.uniform(-0.2, 0.2));
        poses.push_back(pose_at(numbered_name(i), cell + jitter, rng.rotation()));
    }
    return poses;
}

/// The same cameras in another gauge.
inline std::vector<NamedPose> moved(std::vector<NamedPose> poses, const Sim3& target_from_source) {
    for (NamedPose& pose : poses) {
        pose.cam_from_world = transform_pose(pose.cam_from_world, target_from_source);
    }
    return poses;
}

inline Sim3 some_similarity(std::uint64_t seed) {
    synthetic::Rng rng(seed);
    return {rng.uniform(0.1, 10.0), rng.rotation(), 20.0 * rng.normal3()};
}

/// Moves one camera's centre by an offset in the world, its orientation kept.
inline void shift_centre(NamedPose& pose, const Eigen::Vector3d& offset) {
    pose.cam_from_world.translation -= pose.cam_from_world.rotation * offset;
}

/// Turns one camera about its own centre.
inline void turn_in_place(NamedPose& pose, const Eigen::Vector3d& axis, double angle_deg) {
    const Eigen::Vector3d centre = pose.cam_from_world.target_origin_in_source();
    pose = pose_at(
        pose.name, centre,
        Eigen::AngleAxisd(angle_deg * kRadians, axis.normalized()) * pose.cam_from_world.rotation);
}

}  // namespace psfm::test
