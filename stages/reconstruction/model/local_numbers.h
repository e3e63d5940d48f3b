// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "stages/reconstruction/model/cluster_problem.h"

namespace psfm {

/// Where the images of a cluster stand in ClusterProblem::images, by id, in constant time: a table
/// from the smallest to the largest id, 4 bytes each. Immutable; thread-safe.
class LocalNumbers {
  public:
    explicit LocalNumbers(const ClusterProblem& problem) {
        if (problem.images.empty()) return;
        first_ = index_of(problem.images.front().id);
        numbers_.assign(index_of(problem.images.back().id) - first_ + 1, kNone);
        for (std::uint32_t number = 0; number < problem.images.size(); ++number)
            numbers_[index_of(problem.images[number].id) - first_] = number;
    }

    /// Nothing for an image that is not in the cluster.
    std::optional<std::uint32_t> find(ImageId image) const {
        const std::uint32_t place = index_of(image) - first_;  // wraps round below the first
        if (place >= numbers_.size() || numbers_[place] == kNone) return std::nullopt;
        return numbers_[place];
    }
    /// REQUIRES: the image is in the cluster
    std::uint32_t of(ImageId image) const { return numbers_[index_of(image) - first_]; }

  private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFFU;  // Format: is no image's
    std::uint32_t first_ = 0;
    std::vector<std::uint32_t> numbers_;
};

}  // namespace psfm
