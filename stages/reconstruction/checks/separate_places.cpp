// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/separate_places.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "stages/algorithms/math/contract_signed_graph.h"
#include "stages/reconstruction/checks/side_by_side.h"
#include "stages/reconstruction/model/solve_policy.h"

namespace psfm {
namespace {

std::vector<SideBySide> sharing_up_to(std::span<const SideBySide> pairs, double part) {
    std::vector<SideBySide> sharing;
    std::ranges::copy_if(pairs, std::back_inserter(sharing),
                         [&](const SideBySide& pair) { return pair.shared_part() <= part; });
    return sharing;
}

/// Pairs that were found by a few points, with all points counted where these leave a doubt, and
/// where an image of theirs stands beside one of those that share nothing.
std::vector<SideBySide> count_doubtful(const Reconstruction& model, const PlaceOptions& options,
                                       std::span<const SideBySide> pairs,
                                       std::span<const SideBySide> strangers) {
    std::vector<std::uint8_t> is_stranger(model.images.size(), 0);
    for (const SideBySide& pair : strangers) is_stranger[pair.first] = is_stranger[pair.second] = 1;
    std::vector<std::uint8_t> is_near = is_stranger;
    for (const SideBySide& pair : pairs) {
        if (is_stranger[pair.first] != 0 || is_stranger[pair.second] != 0)
            is_near[pair.first] = is_near[pair.second] = 1;
    }
    const auto is_doubtful = [&](const SideBySide& pair) {
        return is_near[pair.first] != 0 || is_near[pair.second] != 0 ||
               pair.shared_part() <= options.clear_part;
    };
    std::vector<SideBySide> counted;
    std::ranges::copy_if(pairs, std::back_inserter(counted), is_doubtful);
    counted = count_all_points(model, options, counted);
    std::ranges::remove_copy_if(pairs, std::back_inserter(counted), is_doubtful);
    return counted;
}

/// By image what its pairs reach: the second best, say, since one may be nearly a copy.
std::vector<double> reached_parts(std::size_t images, std::span<const SideBySide> pairs,
                                  std::size_t rank) {
    std::vector<std::vector<double>> parts(images);
    for (const SideBySide& pair : pairs) {
        parts[pair.first].push_back(pair.shared_part());
        parts[pair.second].push_back(pair.shared_part());
    }
    std::vector<double> reached(images, 0.0);
    for (std::size_t i = 0; i < images; ++i) {
        if (parts[i].empty()) continue;
        std::ranges::sort(parts[i], std::ranges::greater());
        reached[i] = parts[i][std::min(rank, parts[i].size()) - 1];
    }
    return reached;
}

/// Edges of the view graph, and what pairs side by side say in their stead.
std::vector<SignedEdge> weigh(const Reconstruction& model, std::span<const VerifiedPairPtr> edges,
                              std::span<const SideBySide> pairs, const PlaceOptions& options) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> weights;
    const auto position_of = [&](ImageId image) -> std::optional<std::uint32_t> {
        const RegisteredImage* found = model.find(image);
        if (found == nullptr) return std::nullopt;
        return static_cast<std::uint32_t>(found - model.images.data());
    };
    for (const VerifiedPairPtr& edge : edges) {
        const auto first = position_of(edge->pair.first);
        const auto second = position_of(edge->pair.second);
        if (first && second) weights[{*first, *second}] = options.edge_weight;
    }
    const std::vector<double> reached =
        reached_parts(model.images.size(), pairs, options.reached_rank);
    for (const SideBySide& pair : pairs) {
        const double best = std::min(reached[pair.first], reached[pair.second]);
        // Both share as little with whatever stands beside them: that says nothing of this pair.
        if (best <= options.max_shared_by_chance) continue;
        const double relative = pair.shared_part() / best;
        weights[{pair.first, pair.second}] =
            std::clamp((relative - options.same_place) / (1.0 - options.same_place), -1.0, 1.0);
    }
    std::vector<SignedEdge> signed_edges;
    signed_edges.reserve(weights.size());
    for (const auto& [ends, weight] : weights)
        signed_edges.push_back({ends.first, ends.second, weight});
    return signed_edges;
}

/// Parts that another one contradicts.
std::set<std::uint32_t> contradicted(std::span<const std::uint32_t> part_of,
                                     std::span<const SideBySide> pairs,
                                     const PlaceOptions& options) {
    std::map<std::uint32_t, std::uint32_t> images;
    for (const std::uint32_t part : part_of) ++images[part];
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> contradictions;
    for (const SideBySide& pair : pairs) {
        const auto parts = std::minmax(part_of[pair.first], part_of[pair.second]);
        if (parts.first == parts.second || pair.shared_part() > options.max_shared_by_chance)
            continue;
        if (!makes_model(std::min(images[parts.first], images[parts.second]), options.min_images))
            continue;
        ++contradictions[{parts.first, parts.second}];
    }
    std::set<std::uint32_t> result;
    for (const auto& [parts, count] : contradictions) {
        if (count < options.min_contradictions) continue;
        result.insert(parts.first);
        result.insert(parts.second);
    }
    return result;
}

}  // namespace

bool may_show_another_place(const Reconstruction& model, const ScenePoints& seen,
                            std::span<const ImageId> images, const PlaceOptions& options) {
    return options.min_contradictions > 0 &&
           stand_beside_strangers(model, seen, images,
                                  options.glance_factor * options.max_shared_by_chance, options);
}

std::vector<std::vector<ImageId>> separate_places(const Reconstruction& model,
                                                  std::span<const VerifiedPairPtr> pairs,
                                                  const PlaceOptions& options) {
    if (options.min_contradictions == 0) return {};
    // Nearly all models show one place, and a few points of each image are enough to see that.
    const std::vector<SideBySide> glanced =
        find_side_by_side(model, options, options.glance_points);
    const std::vector<SideBySide> suspicious =
        sharing_up_to(glanced, options.glance_factor * options.max_shared_by_chance);
    if (suspicious.size() < options.min_contradictions) return {};
    const std::vector<SideBySide> strangers =
        sharing_up_to(count_all_points(model, options, suspicious), options.max_shared_by_chance);
    if (strangers.size() < options.min_contradictions) return {};
    const std::vector<SideBySide> side_by_side = count_doubtful(model, options, glanced, strangers);
    const std::vector<std::uint32_t> part_of =
        contract_signed_graph(model.images.size(), weigh(model, pairs, side_by_side, options));
    std::map<std::uint32_t, std::vector<ImageId>> places;
    const std::set<std::uint32_t> counting = contradicted(part_of, side_by_side, options);
    for (std::size_t i = 0; i < part_of.size(); ++i) {
        if (counting.contains(part_of[i])) places[part_of[i]].push_back(model.images[i].image);
    }
    std::vector<std::vector<ImageId>> result;
    result.reserve(places.size());
    for (auto& [number, images] : places) result.push_back(std::move(images));
    std::ranges::stable_sort(result, std::ranges::greater(),
                             [](const std::vector<ImageId>& place) { return place.size(); });
    return result;
}

}  // namespace psfm
