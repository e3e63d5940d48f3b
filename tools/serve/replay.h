// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "graph/result.h"
#include "storage/session/session_store.h"

namespace psfm {

struct ReplayOptions {
    /// Versions shown at most, evenly spread over all that are kept. Higher: more to read.
    std::size_t most_versions = 400;
    /// A camera that has moved by less of the session's extent stays where it was shown. Ours; not
    /// tuned.
    double tolerance = 0.003;
};

struct ReplayPose {
    Eigen::Quaternionf cam_from_world;
    Eigen::Vector3f centre;
};

/// Writes versions as docs/serve.md has it ("Replay"). Clusters of a version are laid over where
/// their cameras stand today, as the points are, which no version but the latest has to have.
class ReplayWriter {
  public:
    /// @param tolerance  see ReplayOptions
    ReplayWriter(const Scene& today, double tolerance);
    /// The versions before today's, the oldest first.
    void add(const Scene& scene);
    /// Ends with today's poses, however little they have moved.
    std::string finish();

  private:
    using Poses = std::map<ImageId, ReplayPose>;
    struct Version {
        std::uint32_t images = 0;
        Poses changed;
        std::vector<ImageId> gone;
    };
    void add(std::uint32_t images, const Poses& now, float most, double most_turn);

    Poses today_;
    std::uint32_t images_;
    float most_;  // a camera that has moved less stays where it was shown
    Poses shown_;
    std::vector<Version> versions_;
};

/// The poses of a session's versions, each as what has changed since the one before; empty when no
/// version is kept. No points: each carries when it was born.
/// @errors those of the store
Result<std::string> replay_bytes(const SessionReader& session, const ReplayOptions& options = {});

}  // namespace psfm
