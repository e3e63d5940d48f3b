// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>

#include "graph/scene.h"
#include "storage/exchange/models/export_models.h"

namespace psfm {

/// Inliers and errors of models that have been looked at, so that who asks again and again pays for
/// what has changed: images whose pose, camera or points are others. Grows with the images of the
/// session, and keeps the models of clusters that do not rest. Thread-safe.
class InlierCache {
  public:
    struct Entry {
        std::uint32_t inliers = 0;
        double error_px = 0.0;
    };
    using Entries = std::map<ImageId, Entry>;
    /// By image of the cluster's model. @errors those of residuals_of
    Result<Entries> of(const SceneCluster& cluster, const KeypointsProvider& keypoints);
    /// The same in milliseconds: an image that was measured before is as it was then, and only new
    /// ones are measured.
    Result<Entries> at_once(const SceneCluster& cluster, const KeypointsProvider& keypoints);

  private:
    /// What an image's errors follow from.
    struct Grounds {
        std::uint64_t points = 0;  ///< a sum over its observations, of where they are
        Rigid3 cam_from_cluster;
        Camera camera;
    };
    struct Known {
        std::shared_ptr<const Reconstruction> model;
        std::map<ImageId, Grounds> grounds;
        Entries entries;
    };
    static Result<void> follow(const Reconstruction& model, const KeypointsProvider& keypoints,
                               Known& known);
    std::mutex following_mutex_;  // of what follows
    std::map<ClusterId, Known> known_;
    std::mutex last_mutex_;  // of what follows, held for moments
    Entries last_;           ///< of each image when it was measured last
};

}  // namespace psfm
