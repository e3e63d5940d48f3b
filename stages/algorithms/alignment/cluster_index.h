// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "graph/ids.h"
#include "graph/reconstruction.h"
#include "stages/algorithms/math/kd_tree.h"

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
    static constexpr std::uint32_t kNotAsked = 0xFFFFFFFFU;  // Format: says that there is none
    /// Of an image among those asked for.
    std::uint32_t place_of(ImageId image) const;

    // Tables, since every observation of the model is looked at once.
    std::uint32_t first_image_ = 0;
    std::vector<std::uint32_t> place_of_;  // by image, from the first one on
    /// By place: feature and its point, ascending.
    std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> points_;
};

}  // namespace psfm
