// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "graph/reconstruction.h"

namespace psfm {

/// Where images stand in a model's list, for who asks for each of millions of observations;
/// Reconstruction::find is for who asks now and then. Four bytes for each id up to the largest.
class ImagePlaces {
  public:
    explicit ImagePlaces(const Reconstruction& model)
        : places_(model.images.empty() ? 0 : index_of(model.images.back().image) + 1, kNone) {
        for (std::uint32_t i = 0; i < model.images.size(); ++i)
            places_[index_of(model.images[i].image)] = i;
    }
    /// Nothing when the model lacks the image.
    std::optional<std::uint32_t> operator()(ImageId image) const {
        if (index_of(image) >= places_.size() || places_[index_of(image)] == kNone)
            return std::nullopt;
        return places_[index_of(image)];
    }

  private:
    static constexpr std::uint32_t kNone = ~0U;  // Format: of a place that there is not
    std::vector<std::uint32_t> places_;
};

}  // namespace psfm
