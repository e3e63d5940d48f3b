// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/consistency/stand_together.h"

#include <vector>

#include "graph/sorted_unique.h"
#include "stages/algorithms/alignment/cluster_index.h"
#include "stages/algorithms/alignment/estimate_cluster_constraint.h"
#include "stages/merge/consistency/companions.h"
#include "stages/merge/values/model_cameras.h"

namespace psfm {
namespace {

ClusterIndex index_of_edges(const Reconstruction& model, const ClusterPairEdges& pairs) {
    std::vector<ImageId> images;
    for (const VerifiedPairPtr& edge : pairs.edges) {
        for (const ImageId image : {edge->pair.first, edge->pair.second}) {
            if (model.find(image) != nullptr) images.push_back(image);
        }
    }
    sort_unique(images);
    return {model, images};
}

}  // namespace

bool stand_together(const Reconstruction& a, const Reconstruction& b, const ClusterPairEdges& pairs,
                    const ClusterConstraintOptions& options) {
    if (options.min_unmatched_cameras == 0 || pairs.edges.empty()) return false;
    const ClusterConstraint constraint = estimate_cluster_constraint(
        index_of_edges(a, pairs), index_of_edges(b, pairs), pairs.edges, options);
    if (!constraint.accepted()) return false;
    const ModelCamerasPtr cameras_a = cameras_of(a);
    const ModelCamerasPtr cameras_b = cameras_of(b);
    const CompanionVerdict verdict = judge_companions({&a, cameras_a.get()}, {&b, cameras_b.get()},
                                                      constraint.b_from_a, pairs.matched, options);
    return !verdict.contradict && verdict.matched >= options.min_unmatched_cameras;
}

}  // namespace psfm
