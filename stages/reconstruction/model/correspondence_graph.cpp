// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/correspondence_graph.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <optional>

#include "graph/sorted_unique.h"
#include "stages/algorithms/math/in_parallel.h"

namespace psfm {
namespace {

std::optional<std::uint32_t> local_index(std::span<const ImageId> images, ImageId image) {
    const auto found = std::ranges::lower_bound(images, image);
    if (found == images.end() || *found != image) return std::nullopt;
    return static_cast<std::uint32_t>(found - images.begin());
}

}  // namespace

CorrespondenceGraph::CorrespondenceGraph(std::span<const ImageId> images,
                                         std::span<const std::uint32_t> feature_counts,
                                         std::span<const VerifiedPairPtr> pairs)
    : feature_counts_(feature_counts.begin(), feature_counts.end()),
      partners_(images.size()),
      matches_(images.size()) {
    for (const VerifiedPairPtr& pair : pairs) {
        const auto first = local_index(images, pair->pair.first);
        const auto second = local_index(images, pair->pair.second);
        if (!first || !second) continue;
        partners_[*first].push_back({*second, false, pair});
        partners_[*second].push_back({*first, true, pair});
    }
    for (std::vector<Partner>& partners : partners_)
        std::ranges::sort(partners, {}, &Partner::image);
}

void CorrespondenceGraph::gather(std::uint32_t image) const {
    const auto for_each_match = [&](const auto& use) {
        for (const Partner& partner : partners_[image]) {
            for (const FeatureMatch& match : partner.pair->geometry.inliers) {
                const std::uint32_t own = partner.is_first ? match.second : match.first;
                const std::uint32_t other = partner.is_first ? match.first : match.second;
                if (own < feature_counts_[image] && other < feature_counts_[partner.image])
                    use(own, Feature{partner.image, other});
            }
        }
    };
    Matches& all = matches_[image];
    all.offsets.assign(feature_counts_[image] + 1, 0);
    for_each_match([&](std::uint32_t own, const Feature&) { ++all.offsets[own + 1]; });
    std::partial_sum(all.offsets.begin(), all.offsets.end(), all.offsets.begin());
    all.targets.resize(all.offsets.back());
    // Partners ascend, so that each feature's matches do, too.
    std::vector<std::uint32_t> next(all.offsets.begin(), all.offsets.end() - 1);
    for_each_match(
        [&](std::uint32_t own, const Feature& other) { all.targets[next[own]++] = other; });
}

void CorrespondenceGraph::gather(std::span<const std::uint32_t> images) const {
    std::vector<std::uint32_t> missing;
    std::ranges::copy_if(images, std::back_inserter(missing),
                         [&](std::uint32_t image) { return matches_[image].offsets.empty(); });
    sort_unique(missing);
    in_parallel(missing.size(), [&](std::size_t i) { gather(missing[i]); });
}

void CorrespondenceGraph::forget() const {
    for (Matches& gathered_matches : matches_) gathered_matches = {};
}

}  // namespace psfm
