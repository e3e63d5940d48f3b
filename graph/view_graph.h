// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "graph/ids.h"
#include "graph/two_view_geometry.h"

namespace psfm {

/// The verified pairs of a session that are plausible at present (paper sec. "Progressive
/// Viewgraph"; which ones: select_edges). Nodes are images 0 … size-1. A copy shares what neither
/// changes, and costs a pointer for each 64 images: solves take one along. Thread-safe as a
/// std::vector is; the session's own is of one serial node.
class ViewGraph {
  public:
    struct Edge {
        ImageId neighbor{};
        /// M_ij of the paper: verified correspondences, as far as the pair is plausible; 0: a weak
        /// edge, which counts in no distance and is there for images that have no better one, and
        /// for models to take matches from.
        double weight = 0.0;
        VerifiedPairPtr pair;  ///< may be null in graphs that are made of weights only
    };

    ViewGraph() = default;
    /// Of pairs, each at most once, with as many images as they name.
    explicit ViewGraph(std::span<const VerifiedPairPtr> pairs);

    std::size_t size() const { return size_; }
    std::size_t edge_count() const { return edge_count_; }

    /// The next image. @return its id, equal to the former size()
    ImageId add_node();

    /// REQUIRES: both images are nodes, a != b, no such edge yet, weight >= 0.
    void add_edge(ImageId a, ImageId b, double weight, VerifiedPairPtr pair = nullptr);

    /// REQUIRES: the images are connected.
    void remove_edge(ImageId a, ImageId b);

    /// Neighbours of an image, ascending by id; none of an image that is no node.
    std::span<const Edge> edges(ImageId image) const;

    /// nullptr when the images are not connected.
    const Edge* find(ImageId a, ImageId b) const;

  private:
    static constexpr std::size_t kBlockNodes = 64;  // Guard: what a change copies
    using Edges = std::vector<Edge>;
    using Block = std::array<std::shared_ptr<const Edges>, kBlockNodes>;  // null: no edges

    void set_edges(ImageId image, Edges edges);

    std::vector<std::shared_ptr<const Block>> blocks_;  // null: no edges
    std::size_t size_ = 0;
    std::size_t edge_count_ = 0;
};

}  // namespace psfm
