// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "graph/ids.h"
#include "graph/reconstruction.h"
#include "stages/merge/kd_tree.h"

namespace psfm {

/// What merging asks of one cluster's model. Immutable, hence thread-safe; the model must outlive
/// it.
class ClusterIndex {
  public:
    /// @param images those whose features will be asked for, ascending
    ClusterIndex(const Reconstruction& model, std::span<const ImageId> images);

    const Reconstruction& model() const { return *model_; }
    /// Camera centres, in the order of the model's images.
    const KdTree& centres() const { return centres_; }
    /// By image: distance of its centre to the nearest other one; infinity for a single image.
    const std::vector<double>& neighbor_distances() const { return neighbor_distances_; }
    /// The point that a feature observes.
    std::optional<std::uint32_t> point_of(ImageId image, std::uint32_t feature) const;

  private:
    const Reconstruction* model_;
    KdTree centres_;
    std::vector<double> neighbor_distances_;
    std::unordered_map<ImageId, std::unordered_map<std::uint32_t, std::uint32_t>> points_;
};

}  // namespace psfm
