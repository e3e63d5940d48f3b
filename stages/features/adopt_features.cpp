// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/adopt_features.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace psfm {
namespace {

using Cell = std::pair<long, long>;

Cell cell_of(const Keypoint& keypoint, double size) {
    return {std::lround(keypoint.x / size), std::lround(keypoint.y / size)};
}

/// (distance, place, found), nearest first.
using Pair = std::tuple<double, std::uint32_t, std::uint32_t>;

std::vector<Pair> near_pairs(const Keypoints& places, const Keypoints& found, double distance) {
    std::map<Cell, std::vector<std::uint32_t>> cells;
    for (std::uint32_t f = 0; f < found.size(); ++f)
        cells[cell_of(found[f], distance)].push_back(f);
    std::vector<Pair> pairs;
    for (std::uint32_t p = 0; p < places.size(); ++p) {
        const auto [column, row] = cell_of(places[p], distance);
        for (long x = column - 1; x <= column + 1; ++x) {
            for (long y = row - 1; y <= row + 1; ++y) {
                const auto cell = cells.find({x, y});
                if (cell == cells.end()) continue;
                for (const std::uint32_t f : cell->second) {
                    const double apart = (places[p].position() - found[f].position()).norm();
                    if (apart <= distance) pairs.emplace_back(apart, p, f);
                }
            }
        }
    }
    std::ranges::sort(pairs);
    return pairs;
}

void append(const Descriptors& from, std::uint32_t row, Descriptors& to) {
    const std::uint8_t* first = from.row(row);
    to.values.insert(to.values.end(), first, first + Descriptors::kSize);
}

}  // namespace

AdoptedFeatures adopt_features(const Keypoints& places, const Keypoints& found,
                               const Descriptors& descriptors,
                               const AdoptFeaturesOptions& options) {
    std::vector<std::optional<std::uint32_t>> of_place(places.size());
    std::vector<bool> taken(found.size(), false);
    for (const auto& [distance, place, feature] :
         near_pairs(places, found, options.max_distance_px)) {
        if (of_place[place] || taken[feature]) continue;
        of_place[place] = feature;
        taken[feature] = true;
    }
    AdoptedFeatures result;
    result.keypoints.reserve(places.size() + found.size());
    result.descriptors.values.reserve((places.size() + found.size()) * Descriptors::kSize);
    for (std::size_t p = 0; p < places.size(); ++p) {
        Keypoint keypoint = places[p];
        if (of_place[p]) {
            keypoint = found[*of_place[p]];
            keypoint.x = places[p].x;
            keypoint.y = places[p].y;
            append(descriptors, *of_place[p], result.descriptors);
            ++result.described;
        } else {
            result.descriptors.values.resize(result.descriptors.values.size() + Descriptors::kSize);
        }
        result.keypoints.push_back(keypoint);
    }
    for (std::uint32_t f = 0; f < found.size(); ++f) {
        if (taken[f]) continue;
        result.keypoints.push_back(found[f]);
        append(descriptors, f, result.descriptors);
    }
    return result;
}

}  // namespace psfm
