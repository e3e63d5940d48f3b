// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/describe_events.h"

#include <nlohmann/json.hpp>

namespace psfm {

SessionEvent describe_change(const ClusterChange& change) {
    SessionEvent event;
    event.clusters.push_back(index_of(change.cluster));
    for (const ClusterId other : change.others) event.clusters.push_back(index_of(other));
    const std::string images = std::to_string(change.images) + " images";
    const std::string cluster = std::to_string(index_of(change.cluster));
    if (change.kind == ClusterChange::Kind::kJoin) {
        event.kind = SessionEvent::Kind::kJoin;
        event.text =
            "clusters joined into cluster " + cluster + " of " + images + ", which is solved anew";
    } else {
        event.kind = SessionEvent::Kind::kSplit;
        event.text =
            "images left cluster " + cluster + ", now of " + images + ", which is solved anew";
    }
    return event;
}

SessionEvent describe_solve(const ClusterProblem& problem, const Result<ClusterSolution>& outcome,
                            const ClusterSolution& solution, bool published) {
    const SolveStatistics& statistics = solution.statistics;
    SessionEvent event;
    event.kind = SessionEvent::Kind::kSolve;
    event.clusters = {index_of(problem.cluster)};
    if (!outcome.ok()) {
        event.text = "solve failed: " + outcome.error().message;
    } else {
        event.text = std::string(name_of(statistics.kind)) + ": " +
                     std::to_string(solution.model->images.size()) + " of " +
                     std::to_string(problem.images.size()) + " images, " +
                     std::to_string(solution.model->points.size()) + " points" +
                     (published ? "" : "; the cluster has changed meanwhile");
    }
    event.detail_json = nlohmann::json{{"kind", name_of(statistics.kind)},
                                       {"milliseconds", statistics.milliseconds},
                                       {"full_adjustments", statistics.full_adjustments},
                                       {"local_adjustments", statistics.local_adjustments},
                                       {"removed_edges", statistics.removed_edges},
                                       {"mean_error_px", statistics.mean_error_px}}
                            .dump();
    return event;
}

}  // namespace psfm
