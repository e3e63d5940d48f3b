// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/cluster_problem.h"

#include "stages/reconstruction/model/local_numbers.h"

namespace psfm {
namespace {

std::vector<VerifiedPairPtr> pairs_of(const ClusterProblem& problem, bool weak) {
    const LocalNumbers numbers(problem);
    std::vector<VerifiedPairPtr> pairs;
    for (const ClusterImage& image : problem.images) {
        for (const ViewGraph::Edge& edge : problem.view_graph.edges(image.id)) {
            if (edge.neighbor > image.id && (edge.weight == 0.0) == weak &&
                numbers.find(edge.neighbor))
                pairs.push_back(edge.pair);
        }
    }
    return pairs;
}

}  // namespace

std::vector<VerifiedPairPtr> pairs_of(const ClusterProblem& problem) {
    return pairs_of(problem, /*weak=*/false);
}

std::vector<VerifiedPairPtr> weak_pairs_of(const ClusterProblem& problem) {
    if (!problem.concluding) return {};
    return pairs_of(problem, /*weak=*/true);
}

CameraId lens_of(const ClusterProblem& problem, CameraId camera) {
    const auto twin = problem.twins.find(camera);
    return twin == problem.twins.end() ? camera : twin->second;
}

}  // namespace psfm
