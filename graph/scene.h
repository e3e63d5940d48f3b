// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "graph/image.h"
#include "graph/reconstruction.h"
#include "graph/sim3.h"

namespace psfm {

/// Why an image is not in the model (persistent).
enum class WaitReason : std::uint8_t {
    kNone = 0,
    kTooFewMatches = 1,       ///< no verified pair with another image
    kClusterTooSmall = 2,     ///< its cluster has fewer than mu_min images
    kNoSeed = 3,              ///< no pair of its cluster can start a reconstruction
    kRegistrationFailed = 4,  ///< too few consistent 2D-3D correspondences
    kSolving = 5,             ///< its cluster has not been solved since it arrived
    kNoParallax = 6,          ///< its pairs show that the camera only turned: no depth follows
    kStandsStill = 7,         ///< what it has in common with others stands still in the photograph
    kTooFewFeatures = 8,      ///< hardly any feature was found in it
    kLookAlikes = 9,          ///< what it matches could be another thing that looks alike
};
const char* describe(WaitReason reason);
/// A word for programs: "no_parallax".
const char* name_of(WaitReason reason);

/// One cluster of a scene version.
struct SceneCluster {
    ClusterId id{};
    std::uint32_t revision =
        0;  ///< counts the published solutions of this cluster, from 1; 0: none yet
    std::vector<ImageId> members;                 ///< ascending
    std::shared_ptr<const Reconstruction> model;  ///< null or empty while unsolved
    Sim3 world_from_cluster;
    std::uint32_t effective_cluster =
        0;  ///< index into the version's effective clusters, largest first
};

/// An immutable version of everything that is published.
struct Scene {
    std::uint64_t version = 0;
    std::uint32_t image_count = 0;         ///< accepted images that this version knows of
    std::uint32_t effective_clusters = 0;  ///< number of those that hold a model
    std::vector<std::shared_ptr<const SceneCluster>> clusters;  ///< ascending by id
};

using ScenePtr = std::shared_ptr<const Scene>;

/// Placed images of a scene, over all clusters.
std::size_t placed_count(const Scene& scene);

}  // namespace psfm
