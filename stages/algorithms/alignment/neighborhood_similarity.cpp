// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/neighborhood_similarity.h"

#include <cmath>
#include <cstddef>

namespace psfm {
namespace {

/// Guard: cameras of a model that are asked at most: of more only every so many-th is. With a
/// thousand the similarity is known to a hundredth or so, and what an edge between two large models
/// costs does not grow with them. Ours.
constexpr std::size_t kMostAsked = 1000;

/// Where the source's image is in the target's model, too: until a cluster that lost an image is
/// solved again, two models have it, and it is no neighbour of itself.
std::size_t position_of(const ClusterIndex& source, std::size_t k, const ClusterIndex& target) {
    const RegisteredImage* same = target.model().find(source.model().images[k].image);
    return same == nullptr ? KdTree::kNone
                           : static_cast<std::size_t>(same - target.model().images.data());
}

/// @param target_from_source brings the cameras of `source` among those of `target`
void count_kept(const ClusterIndex& source, const ClusterIndex& target,
                const Sim3& target_from_source, NeighborhoodCount& count) {
    const std::size_t cameras = source.centres().size();
    const std::size_t step = (cameras + kMostAsked - 1) / kMostAsked;
    for (std::size_t k = step / 2; k < cameras; k += step) {
        const double own = source.neighbor_distances()[k];
        if (!std::isfinite(own)) continue;
        count.all += step;
        const Eigen::Vector3d centre = target_from_source * source.centres().points()[k];
        if (!target.centres().has_nearer(centre, target_from_source.scale * own,
                                         position_of(source, k, target)))
            count.kept += step;
    }
}

}  // namespace

NeighborhoodCount count_kept_neighbors(const ClusterIndex& a, const ClusterIndex& b,
                                       const Sim3& b_from_a) {
    NeighborhoodCount count;
    count_kept(a, b, b_from_a, count);
    count_kept(b, a, inverse(b_from_a), count);
    return count;
}

}  // namespace psfm
