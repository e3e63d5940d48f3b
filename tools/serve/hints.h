// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "graph/image.h"
#include "graph/scene.h"
#include "tools/report/edge_facts.h"

namespace psfm {

/// Where the next photograph helps most, in words for who takes it.
struct Hint {
    enum class Kind : std::uint8_t {
        kJoinParts,  ///< a pair leads from one part to another
        kLookAlike,  ///< two places look alike; what lies between tells them apart
        kFewPoints,  ///< few observations hold a camera
        kLowAngle,   ///< its points are seen from nearly one direction
    };
    Kind kind{};
    ImageId image{};  ///< where it is about
    std::string text;
};
std::string_view hint_name(Hint::Kind kind);

struct HintOptions {
    std::size_t most = 10;  ///< told at once. Higher: nobody reads them. Not tuned.
    /// A camera with fewer observations than this part of the median is thin. Ours; not tuned.
    double few_points = 0.3;
    /// Below this median angle between a camera's rays and those of others that see the same points
    /// [deg], depths are poor. COLMAP's minimum for a first pair is 16, for a point 1.5. Ours; not
    /// tuned.
    double low_angle_deg = 2.5;
};

/// Computes hints from models and their pairs, and keeps what it has found out about models that
/// have not changed.
class HintBook {
  public:
    /// A cluster's model with its points, where the scene's has none because the cluster rests;
    /// null: it is not to be had, and nothing is said of its cameras. May be empty.
    using WholeModel =
        std::function<std::shared_ptr<const Reconstruction>(const SceneCluster& cluster)>;

    explicit HintBook(const HintOptions& options = {}) : options_(options) {}

    /// The most urgent first. Cost: of all points of models that have changed.
    /// @param names  what photographs are called, by image id
    std::vector<Hint> hints(const Scene& scene, const std::vector<EdgeFact>& edges,
                            const std::vector<std::string>& names, const WholeModel& whole = {});

  private:
    struct Support {
        std::size_t observations = 0;
        float angle_deg = 0.F;  ///< median, between its rays and those of others
    };
    struct Known {
        std::shared_ptr<const Reconstruction> model;
        std::uint32_t revision = 0;
        std::map<ImageId, Support> support;
    };
    static std::map<ImageId, Support> support_in(const Reconstruction& model);
    void follow(const Scene& scene, const WholeModel& whole);

    HintOptions options_;
    std::map<ClusterId, Known> known_;
};

}  // namespace psfm
