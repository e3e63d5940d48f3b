// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/companions.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include "stages/algorithms/math/in_parallel.h"

namespace psfm {
namespace {

/// Guard: more images of one track say no more about who stands where.
constexpr std::size_t kCountedOfTrack = 24;

/// Guard: part of a model's images that companions may be: of a small model more would stand on the
/// other side of what it shows twice. It changes results of models with fewer than six times
/// BetweenOptions::companions, and was chosen on look-alikes: of 96 random parts of 8 to 17
/// photographs of them (docs/experiments/subsets.md has some) 156 images end wrong so, and 190 with
/// four companions each. It would be an option if the options came here.
constexpr std::uint32_t kOneOf = 6;

/// Of the points that an image sees, those who see them, too: some of each track.
using Tracks = std::vector<std::span<const Observation>>;

std::vector<std::uint32_t> most_in_common(std::uint32_t own, const Tracks& tracks,
                                          const std::vector<std::uint32_t>& positions,
                                          std::size_t images, std::uint32_t count) {
    std::vector<std::uint32_t> common(images, 0);
    for (const std::span<const Observation> track : tracks) {
        const std::size_t counted = std::min(track.size(), kCountedOfTrack);
        for (std::size_t k = 0; k < counted; ++k)
            ++common[positions[index_of(track[k * track.size() / counted].image)]];
    }
    common[own] = 0;
    std::vector<std::uint32_t> most;
    for (std::uint32_t image = 0; image < images; ++image) {
        if (common[image] > 0) most.push_back(image);
    }
    const auto has_more = [&](std::uint32_t a, std::uint32_t b) {
        return common[a] != common[b] ? common[a] > common[b] : a < b;
    };
    const auto kept = std::min<std::size_t>(count, most.size());
    std::ranges::partial_sort(most, most.begin() + static_cast<std::ptrdiff_t>(kept), has_more);
    most.resize(kept);
    return most;
}

}  // namespace

std::vector<std::uint32_t> positions_by_id(const Reconstruction& model) {
    std::vector<std::uint32_t> positions;
    if (model.images.empty()) return positions;
    positions.resize(std::size_t{index_of(model.images.back().image)} + 1);
    for (std::uint32_t i = 0; i < model.images.size(); ++i)
        positions[index_of(model.images[i].image)] = i;
    return positions;
}

std::vector<std::vector<std::uint32_t>> companions_of(const Reconstruction& model,
                                                      std::uint32_t count) {
    const auto images = static_cast<std::uint32_t>(model.images.size());
    count = std::min(count, images / kOneOf);
    const std::vector<std::uint32_t> positions = positions_by_id(model);
    std::vector<Tracks> tracks(model.images.size());
    for (const ScenePoint& point : model.points) {
        for (const Observation& observation : point.track)
            tracks[positions[index_of(observation.image)]].emplace_back(point.track);
    }
    std::vector<std::vector<std::uint32_t>> companions(model.images.size());
    in_parallel(companions.size(), [&](std::size_t i) {
        companions[i] = most_in_common(static_cast<std::uint32_t>(i), tracks[i], positions,
                                       companions.size(), count);
    });
    return companions;
}

}  // namespace psfm
