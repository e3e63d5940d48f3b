// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/ids.h"
#include "graph/two_view_geometry.h"

namespace psfm {

/// The verified pairs of a session that are plausible at present (paper sec. "Progressive
/// Viewgraph"; which ones: select_edges). Nodes are images 0 … size-1. Not thread-safe: owned by
/// one serial node.
class ViewGraph {
  public:
    struct Edge {
        ImageId neighbor{};
        double weight = 0.0;   ///< M_ij of the paper: verified correspondences
        VerifiedPairPtr pair;  ///< may be null in graphs that are made of weights only
    };

    std::size_t size() const { return adjacency_.size(); }
    std::size_t edge_count() const { return edge_count_; }

    /// The next image. @return its id, equal to the former size()
    ImageId add_node();

    /// REQUIRES: both images are nodes, a != b, no such edge yet, weight > 0.
    void add_edge(ImageId a, ImageId b, double weight, VerifiedPairPtr pair = nullptr);

    /// REQUIRES: the images are connected.
    void remove_edge(ImageId a, ImageId b);

    /// Neighbours of an image, ascending by id.
    std::span<const Edge> edges(ImageId image) const { return adjacency_[index_of(image)]; }

    /// nullptr when the images are not connected.
    const Edge* find(ImageId a, ImageId b) const;

  private:
    std::vector<std::vector<Edge>> adjacency_;
    std::size_t edge_count_ = 0;
};

}  // namespace psfm
