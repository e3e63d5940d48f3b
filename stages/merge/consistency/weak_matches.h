// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <unordered_map>

#include "graph/ids.h"
#include "graph/two_view_geometry.h"
#include "graph/view_graph.h"

namespace psfm {

/// Which weak pairs match cameras of different clusters (judge_companions): those that share a fair
/// part of what their images share at best. In streams of video a true pair is weak beside
/// near-identical ones, but not by much; look-alikes share far less. Ours;
/// docs/notebook/2026-11-30-a-joint-of-look-alikes.md has the figures. Not thread-safe.
class WeakMatches {
  public:
    /// @param min_part  ClusterConstraintOptions::min_weak_part
    /// REQUIRES: the graph outlives this, does not change meanwhile, and all of its edges have
    /// pairs
    WeakMatches(const ViewGraph& graph, double min_part) : graph_(&graph), min_part_(min_part) {}

    /// @param weak  of images of the graph; whether it is an edge there does not matter
    bool match(const VerifiedPair& weak);

  private:
    /// Inliers of the best edge of an image, a weak one as well; 0 without any.
    std::size_t most_inliers(ImageId image);

    const ViewGraph* graph_;
    double min_part_;
    std::unordered_map<ImageId, std::size_t> most_;  ///< of images that were asked for
};

}  // namespace psfm
