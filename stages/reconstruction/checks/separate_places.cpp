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
#include "stages/reconstruction/checks/seen_between.h"
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

/// The model's pairs, by positions of their images.
using PairWeights = std::map<std::pair<std::uint32_t, std::uint32_t>, double>;

PairWeights weights_of(const Reconstruction& model, std::span<const VerifiedPairPtr> edges,
                       double weight) {
    PairWeights weights;
    const auto position_of = [&](ImageId image) -> std::optional<std::uint32_t> {
        const RegisteredImage* found = model.find(image);
        if (found == nullptr) return std::nullopt;
        return static_cast<std::uint32_t>(found - model.images.data());
    };
    for (const VerifiedPairPtr& edge : edges) {
        const auto first = position_of(edge->pair.first);
        const auto second = position_of(edge->pair.second);
        if (first && second) weights[{*first, *second}] = weight;
    }
    return weights;
}

/// What is seen from both sides, by edges of the view graph.
struct Between {
    std::vector<SeenBetween> pairs;
    double shared_part = 1.0;  ///< of all of them
};

Between between_of(const Reconstruction& model, const PairWeights& edges,
                   const PlaceOptions& options) {
    Between between;
    between.pairs = find_seen_between(model, options.between, options.between_points);
    std::erase_if(between.pairs, [&](const SeenBetween& pair) {
        return pair.expected < options.min_expected || !edges.contains({pair.first, pair.second});
    });
    double expected = 0.0;
    double shared = 0.0;
    for (const SeenBetween& pair : between.pairs) {
        expected += pair.expected;
        shared += pair.shared;
    }
    if (shared > 0.0) between.shared_part = shared / expected;
    return between;
}

/// How much speaks for one place or for two, up to 1 where all or nothing is shared.
double says(double relative_part, double same_place) {
    return std::clamp((relative_part - same_place) / (1.0 - same_place), -1.0, 1.0);
}

/// Edges of the view graph, what is seen from both sides in their stead where it is, and what pairs
/// side by side say in the stead of either.
std::vector<SignedEdge> weigh(std::size_t images, PairWeights weights, const Between& between,
                              std::span<const SideBySide> side_by_side,
                              const PlaceOptions& options) {
    for (const SeenBetween& pair : between.pairs) {
        const double strength =
            std::min(1.0, static_cast<double>(pair.expected) / options.full_between);
        weights[{pair.first, pair.second}] =
            strength * says(pair.shared_part() / between.shared_part, options.same_between);
    }
    const std::vector<double> reached = reached_parts(images, side_by_side, options.reached_rank);
    for (const SideBySide& pair : side_by_side) {
        const double best = std::min(reached[pair.first], reached[pair.second]);
        // Both share as little with whatever stands beside them: that says nothing of this pair.
        if (best <= options.max_shared_by_chance) continue;
        weights[{pair.first, pair.second}] = says(pair.shared_part() / best, options.same_place);
    }
    std::vector<SignedEdge> signed_edges;
    signed_edges.reserve(weights.size());
    for (const auto& [ends, weight] : weights)
        signed_edges.push_back({ends.first, ends.second, weight});
    return signed_edges;
}

/// What speaks for two parts' being two places.
struct Contradictions {
    std::uint32_t strangers = 0;  ///< pairs side by side that share nothing
    std::uint32_t pairs = 0;      ///< that have to share something, seen from both sides
    double expected = 0.0;
    double shared = 0.0;

    /// @param shared_part  of all that is seen from both sides
    /// @param within  what is expected so within the smaller part
    bool are_two_places(double shared_part, double within, const PlaceOptions& options) const {
        const bool is_fold = pairs >= options.min_contradictions &&
                             expected >= options.min_between &&
                             within >= options.min_within * expected &&
                             shared < options.folded_between * shared_part * expected;
        return strangers >= options.min_contradictions || is_fold;
    }
};

/// Parts that another one contradicts.
std::set<std::uint32_t> contradicted(std::span<const std::uint32_t> part_of, const Between& between,
                                     std::span<const SideBySide> side_by_side,
                                     const PlaceOptions& options) {
    std::map<std::uint32_t, std::uint32_t> images;
    for (const std::uint32_t part : part_of) ++images[part];
    std::map<std::pair<std::uint32_t, std::uint32_t>, Contradictions> by_parts;
    const auto between_parts = [&](std::uint32_t first, std::uint32_t second) -> Contradictions* {
        const auto parts = std::minmax(part_of[first], part_of[second]);
        const std::uint32_t smaller = std::min(images[parts.first], images[parts.second]);
        if (parts.first == parts.second || !makes_model(smaller, options.min_images))
            return nullptr;
        return &by_parts[{parts.first, parts.second}];
    };
    for (const SideBySide& pair : side_by_side) {
        if (pair.shared_part() > options.max_shared_by_chance) continue;
        if (Contradictions* found = between_parts(pair.first, pair.second)) ++found->strangers;
    }
    std::map<std::uint32_t, double> within;
    for (const SeenBetween& pair : between.pairs) {
        if (part_of[pair.first] == part_of[pair.second])
            within[part_of[pair.first]] += pair.expected;
        Contradictions* found = between_parts(pair.first, pair.second);
        if (found == nullptr) continue;
        ++found->pairs;
        found->expected += pair.expected;
        found->shared += pair.shared;
    }
    std::set<std::uint32_t> result;
    for (const auto& [parts, found] : by_parts) {
        const auto [first, second] = parts;
        const std::uint32_t smaller = images[first] < images[second] ? first : second;
        if (!found.are_two_places(between.shared_part, within[smaller], options)) continue;
        result.insert({first, second});
    }
    return result;
}

/// Pairs side by side that may tell of two places; none where too few of them share nothing.
std::vector<SideBySide> doubtful_pairs(const Reconstruction& model, const PlaceOptions& options) {
    // Nearly all models show one place, and a few points of each image are enough to see that.
    const std::vector<SideBySide> glanced =
        find_side_by_side(model, options, options.glance_points);
    const std::vector<SideBySide> suspicious =
        sharing_up_to(glanced, options.glance_factor * options.max_shared_by_chance);
    if (suspicious.size() < options.min_contradictions) return {};
    const std::vector<SideBySide> strangers =
        sharing_up_to(count_all_points(model, options, suspicious), options.max_shared_by_chance);
    if (strangers.size() < options.min_contradictions) return {};
    return count_doubtful(model, options, glanced, strangers);
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
    const std::vector<SideBySide> side_by_side = doubtful_pairs(model, options);
    PairWeights edges = weights_of(model, pairs, options.edge_weight);
    const Between between = between_of(model, edges, options);
    const auto shares_little = [&](const SeenBetween& pair) {
        return pair.shared_part() < options.folded_between * between.shared_part;
    };
    if (side_by_side.empty() &&
        std::ranges::count_if(between.pairs, shares_little) < options.min_contradictions)
        return {};
    const std::vector<std::uint32_t> part_of = contract_signed_graph(
        model.images.size(),
        weigh(model.images.size(), std::move(edges), between, side_by_side, options));
    std::map<std::uint32_t, std::vector<ImageId>> places;
    const std::set<std::uint32_t> counting = contradicted(part_of, between, side_by_side, options);
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
