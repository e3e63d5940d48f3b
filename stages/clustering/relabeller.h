// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "graph/ids.h"
#include "stages/clustering/apply_relabelling.h"
#include "stages/clustering/clustering_options.h"
#include "stages/clustering/clustering_state.h"

namespace psfm {

/// Joins and splits groups of images on top of a state, whose cluster_of it gives provisional
/// labels: former clusters have their ids, new groups unused numbers. The other members of the
/// state stay as they are until apply_relabelling.
class Relabeller {
  public:
    /// Images that the state does not know yet are groups of one each.
    /// @param graph_size  images in all; REQUIRES: at least state.size()
    Relabeller(ClusteringState& state, std::size_t graph_size, const ClusteringOptions& options);

    /// Joins the groups of two images, the smaller one into the larger (ties: into the older
    /// label), unless they are one or may not join.
    void join(ImageId x, ImageId y);

    /// Makes images of one group, not all of it, a group of their own. @return its label
    ClusterId split_off(const std::vector<ImageId>& part);

    /// Images that have a label now.
    std::vector<ImageId> images_of(ClusterId label) const;

    /// What became of the labels; the relabeller is done then.
    Relabelling take();

  private:
    ClusterId fresh_label();
    std::size_t size_of(ClusterId label) const;
    void relabel(ImageId image, ClusterId label);

    ClusteringState& state_;
    ClusteringOptions options_;
    std::size_t former_size_;
    ClusterId next_label_;
    std::map<ClusterId, std::vector<ImageId>>
        gained_;                              ///< some have gone on to another group since
    std::map<ClusterId, std::size_t> sizes_;  ///< of groups that changed
    Relabelling relabelling_;
};

}  // namespace psfm
