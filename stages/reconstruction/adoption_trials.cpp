// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adoption_trials.h"

#include <algorithm>
#include <utility>

namespace psfm {

bool AdoptionTrials::Ground::operator==(const Ground& other) const {
    return pair == other.pair && cluster == other.cluster && revision == other.revision &&
           effective_cluster == other.effective_cluster &&
           frame_from_cluster.scale == other.frame_from_cluster.scale &&
           frame_from_cluster.rotation.coeffs() == other.frame_from_cluster.rotation.coeffs() &&
           frame_from_cluster.translation == other.frame_from_cluster.translation;
}

AdoptionTrials::Grounds AdoptionTrials::grounds_of(const MergeProblem& problem,
                                                   const MergeResult& merged,
                                                   const UnplacedImage& image) {
    Grounds grounds;
    std::map<std::uint32_t, const ClusterPlacement*> frames;
    for (const UnplacedImage::Edge& edge : image.edges) {
        const auto cluster =
            std::ranges::lower_bound(problem.clusters, edge.cluster, {}, &MergeCluster::id);
        const auto placement =
            std::ranges::lower_bound(merged.placements, edge.cluster, {}, &ClusterPlacement::id);
        const ClusterPlacement& frame =
            *frames.emplace(placement->effective_cluster, &*placement).first->second;
        grounds.push_back({edge.pair, edge.cluster, cluster->revision, placement->effective_cluster,
                           frame_from_cluster(frame, *placement)});
    }
    return grounds;
}

std::vector<Adoption> AdoptionTrials::find(const MergeProblem& problem, const MergeResult& merged,
                                           std::span<const UnplacedImage> unplaced,
                                           const SolveOptions& options) {
    std::map<ImageId, Trial> trials;
    std::vector<UnplacedImage> changed;
    for (const UnplacedImage& image : unplaced) {
        Trial trial{image.tried_by, grounds_of(problem, merged, image)};
        const auto before = in_vain_.find(image.id);
        if (before == in_vain_.end() || before->second != trial) changed.push_back(image);
        trials.emplace(image.id, std::move(trial));
    }
    tried_ = changed.size();
    auto adoptions = find_adoptions(problem, merged, changed, options);
    // An adoption may come to nothing, where its host has changed meanwhile, and is then due again.
    for (const Adoption& adoption : adoptions) trials.erase(adoption.image);
    in_vain_ = std::move(trials);
    return adoptions;
}

}  // namespace psfm
