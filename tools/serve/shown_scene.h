// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "graph/scene.h"
#include "tools/serve/shown_cluster.h"

namespace psfm {

/// What the scene itself does not hold.
struct ModelSource {
    /// Colour of a feature, asked for once for each new point: that of its first observation.
    std::function<Colour(const Observation&)> colour;
    /// A cluster's model with its points, of a cluster that rests and has been solved since it was
    /// shown last; null: not to be had, and its points stay as they are shown. May be empty.
    std::function<std::shared_ptr<const Reconstruction>(const SceneCluster&)> model;
};

/// How exactly watchers are told where points and cameras are.
struct ShowOptions {
    /// What has moved by less of the model's extent, beside the cluster as a whole, is not told.
    /// Higher: a model that looks wrong; lower: more bytes (3 times the points of the
    /// final model at 0.005, 19 times at 0.0001). While photographs come; ours.
    double tolerance = 0.005;
    /// The same once everything has settled.
    double settled_tolerance = 0.0005;
    /// Of the change before the first. A server begins elsewhere each time, so that nobody takes
    /// its changes for those of the one before it.
    std::uint32_t number = 0;
};

/// The model as those have it who have been told of all changes so far. One thread at a time.
///
/// A point is known by its first observation, which it keeps while it is extended. Points lie in
/// slots of their cluster; a slot is never used again. Each cluster is shown in a frame of its own,
/// which follows the cluster's gauge by a similarity, so that a model that only turns, shifts or
/// grows is told in eight numbers.
class ShownScene {
  public:
    explicit ShownScene(const ShowOptions& options = {})
        : options_(options), number_(options.number) {}

    /// Brings what is shown up to a scene. Clusters whose model is the same object as before are
    /// only placed; those whose points are not at hand (resting ones, whose revision is the same)
    /// keep theirs.
    /// @return the change, from change_header to its last part; no part where nothing has changed
    std::string update(const Scene& scene, const ModelSource& sources, bool settled);

    /// All of it, as one change with the number of the last one, for who knows nothing yet.
    std::string snapshot() const;

    std::uint32_t number() const { return number_; }
    std::size_t point_count() const;

    /// First observation of what is in a slot; nothing where none is.
    std::optional<Observation> key_of(ClusterId cluster, std::uint32_t slot) const;
    /// The slot of a point of that first observation; nothing when it is not shown.
    std::optional<std::uint32_t> slot_of(ClusterId cluster, const Observation& first) const;

  private:
    using Point = ShownPoint;
    using Pose = ShownPose;
    using Cluster = ShownCluster;

    void hand_over(const Scene& scene, std::string& changes);
    void hand_over(ClusterId from, Cluster& source, ClusterId to, Cluster& target,
                   const Reconstruction& model, std::string& changes);
    void follow(ClusterId id, Cluster& shown, const SceneCluster& cluster,
                const ModelSource& sources, bool settled, std::string& changes);
    void follow_points(ClusterId id, Cluster& shown, const Reconstruction& model,
                       const ModelSource& sources, double tolerance, std::string& changes);
    static void drop_points(ClusterId id, Cluster& shown, std::vector<std::uint32_t> dropped,
                            std::string& changes);
    void follow_poses(ClusterId id, Cluster& shown, const Reconstruction& model, double tolerance,
                      std::string& changes);

    ShowOptions options_;
    std::map<ClusterId, Cluster> clusters_;
    std::uint32_t number_ = 0;
    std::uint64_t version_ = 0;
    std::uint32_t images_ = 0;
};

}  // namespace psfm
