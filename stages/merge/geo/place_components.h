// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "graph/ids.h"
#include "graph/image.h"
#include "graph/reconstruction.h"
#include "graph/scene.h"
#include "graph/sim3.h"
#include "stages/merge/geo/georeference.h"
#include "stages/merge/geo/keep_frame.h"
#include "stages/merge/values/image_evidence.h"
#include "stages/merge/values/merge_options.h"
#include "stages/merge/values/model_cameras.h"

namespace psfm {

/// A cluster to be placed.
struct MergeCluster {
    ClusterId id{};
    std::uint32_t revision = 0;                   ///< changes whenever the model does
    std::shared_ptr<const Reconstruction> model;  ///< null or empty while unsolved
    ModelCamerasPtr cameras = nullptr;            ///< of this model; null: not known yet
};

/// Clusters that stand in one frame: an effective cluster.
struct Component {
    std::vector<const MergeCluster*> clusters;  ///< ascending by id; all with a model
    std::vector<Sim3> component_from_cluster;
    std::size_t placed = 0;  ///< images
};

/// What a component's frame rests on.
enum class FrameSource : std::uint8_t {
    kVision,       ///< where its images were before, or a gauge of its own
    kGravity,      ///< the same, turned upright
    kWhereabouts,  ///< the same, where its positions are; neither scale nor heading are known
    kPositions,    ///< its photographs' positions tell all
};

struct ComponentPlace {
    Sim3 world_from_component;
    FrameSource source = FrameSource::kVision;
    PositionAgreement agreement;  ///< with the datum's frame, as placed; empty without a datum
};

struct PlacedComponents {
    std::vector<ComponentPlace> places;  ///< by component
    /// The world is the east-north-up frame about this; empty while no component has enough
    /// evidence, then the world's gauge is arbitrary.
    std::optional<GpsPosition> datum;
};

/// Frames of all components, such that nothing published jumps without a reason.
/// 1. *Vision.* A component with images that `previous` placed is moved as a whole by the
///    similarity that brings most of them where they were (keep_frame.h). A new one has the gauge
///    of its largest cluster, scaled so that the median distance of a camera to its nearest
///    neighbour is 1.
///    Where that moves half of a component's anchors away (two and more: from where `previous` has
///    them, else from where they were when the session began), these alone say: a model that a
///    session began with may be lost for a time, or be joined by a larger one; its world is not.
/// 2. *Positions.* A component with enough evidence (georeference.h) has a place on the earth. It
///    stays where 1 has it as long as that is within `hold` standard errors of the place (root mean
///    square over its cameras) and turned against it by no more than as many of the heading's, or
///    `hold_angle_deg`; otherwise it moves there. So the first version with enough evidence moves
///    once; after that a component only moves when the estimate has changed by more than its error,
///    and then to the estimate. With few positions the robust estimate may find another minimum:
///    steps of some standard errors. The same evidence leaves it where it was, but for rounding.
/// 3. *Gravity and whereabouts.* Where some component has a place and this one has not, it is
///    turned about its middle until up is +z, by the smallest turn, unless 1 has it upright within
///    `hold` standard deviations of gravity. If it has positions at all, and the median difference
///    to its cameras is more than three standard deviations of one, it is shifted by that (the
///    paper's "coarse cluster-wise GPS locations"). All else is kept: heading and scale, which say
///    nothing for a component that was never published, and the place on the earth of one that has
///    lost its evidence (a split).
/// Without positions, or with use_gps off, 1 is all. Components never change in themselves, and
/// their number never changes: positions put them into relation, vision alone joins them.
/// @param anchors   ascending by image, each once
/// @param evidence  ascending by image; images that it lacks have neither position nor orientation
/// Deterministic. Thread-safe.
PlacedComponents place_components(std::span<const Component> components, const Scene* previous,
                                  std::span<const WorldAnchor> anchors,
                                  std::span<const ImageEvidence> evidence,
                                  const MergeOptions& options);

}  // namespace psfm
