// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/cluster_problem.h"

#include "stages/reconstruction/local_numbers.h"

namespace psfm {

std::vector<VerifiedPairPtr> pairs_of(const ClusterProblem& problem) {
    const LocalNumbers numbers(problem);
    std::vector<VerifiedPairPtr> pairs;
    for (const ClusterImage& image : problem.images) {
        for (const ViewGraph::Edge& edge : problem.view_graph.edges(image.id)) {
            if (edge.neighbor > image.id && numbers.find(edge.neighbor)) pairs.push_back(edge.pair);
        }
    }
    return pairs;
}

}  // namespace psfm
