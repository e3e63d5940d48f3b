// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/rival_models.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "stages/algorithms/math/union_find.h"

namespace psfm {
namespace {

bool are_of_the_same_pairs(const std::vector<ModelEdge>& one, const std::vector<ModelEdge>& other) {
    const auto pair_of = [](const ModelEdge& edge) { return edge.pair->pair; };
    return std::ranges::equal(one, other, {}, pair_of, pair_of);
}

/// Squares of the relative matches of edges that one model explains and the other denies.
double explained_alone(const std::vector<ModelEdge>& one, const std::vector<ModelEdge>& other,
                       const DoubtOptions& options) {
    double sum = 0.0;
    for (std::size_t i = 0; i < one.size(); ++i) {
        if (one[i].is_explained(options) && other[i].explained < options.max_denied)
            sum += one[i].relative * one[i].relative;
    }
    return sum;
}

bool is_rival(const OtherModel& other, const Judged& best, const DoubtOptions& options) {
    return is_about_as_good(other.score, best.score, options) &&
           are_of_the_same_pairs(other.edges, best.edges) &&
           explained_alone(other.edges, best.edges, options) >= options.min_rivalry &&
           explained_alone(best.edges, other.edges, options) >= options.min_rivalry;
}

}  // namespace

std::vector<std::vector<ImageId>> parts_in_common(const Judged& best,
                                                  std::span<const OtherModel> others,
                                                  const DoubtOptions& options) {
    std::vector<const OtherModel*> rivals;
    for (const OtherModel& other : others) {
        if (is_rival(other, best, options)) rivals.push_back(&other);
    }
    if (rivals.empty()) return {};
    const std::vector<RegisteredImage>& images = best.attempt.model.images;
    UnionFind<> sets(images.size());
    for (std::size_t i = 0; i < best.edges.size(); ++i) {
        const ModelEdge& edge = best.edges[i];
        const bool is_common =
            edge.is_explained(options) && std::ranges::all_of(rivals, [&](const OtherModel* rival) {
                return rival->edges[i].is_explained(options);
            });
        if (is_common) sets.join(edge.first, edge.second);
    }
    std::map<std::uint32_t, std::vector<ImageId>> by_root;
    for (std::uint32_t i = 0; i < images.size(); ++i)
        by_root[sets.root_of(i)].push_back(images[i].image);
    if (by_root.size() < 2) return {};
    std::vector<std::vector<ImageId>> parts;
    parts.reserve(by_root.size());
    for (auto& [root, part] : by_root) parts.push_back(std::move(part));
    std::ranges::stable_sort(parts, std::ranges::greater(),
                             [](const std::vector<ImageId>& part) { return part.size(); });
    return parts;
}

}  // namespace psfm
