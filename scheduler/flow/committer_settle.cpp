// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The committer at the end of the photographs: what was held apart is joined, and every model is
// adjusted to convergence.
#include <algorithm>
#include <utility>

#include "scheduler/flow/committer.h"
#include "scheduler/report/describe_events.h"

namespace psfm {

Result<void> Committer::conclude(CommitOutput& output) {
    state_.concluding = true;
    if (!std::exchange(settle_first_, false)) {
        auto edit = keeper_.forget_places();
        if (edit.ok() && !changes_clusters(*edit)) edit = keeper_.join_late();
        if (edit.ok() && !changes_clusters(*edit)) edit = keeper_.reunite_places();
        if (!edit.ok()) return edit.error();
        if (changes_clusters(*edit)) {
            changed_ = true;
            if (const auto done = store_->commit_clusters(*edit); !done.ok()) return done.error();
            return start_solves(state_.clusters.take_dirty(), /*settle=*/false, output);
        }
    }
    begin_settling();
    return go_on_settling(output);
}

void Committer::begin_settling() {
    std::vector<SettlingModel> models;
    for (const ClusterEntry* entry : state_.clusters.take_unsettled())
        models.push_back({entry->id, state_.clusters.images_of(*entry).size()});
    if (models.empty()) return;
    outbox_.events.push_back(describe_settling(models));
    // One that begins last is waited for by all.
    std::ranges::stable_sort(models, std::ranges::greater(), &SettlingModel::images);
    for (const SettlingModel& model : models) to_settle_.push_back(model.cluster);
}

Result<void> Committer::go_on_settling(CommitOutput& output) {
    while (!to_settle_.empty() && (config_.deterministic || settling_ < pace_.settle_at_once)) {
        const ClusterEntry* entry = state_.clusters.begin_taken(to_settle_.front());
        to_settle_.pop_front();
        if (entry == nullptr) continue;
        if (const auto started = start_solves({entry}, /*settle=*/true, output); !started.ok())
            return started.error();
        ++settling_;
    }
    return {};
}

}  // namespace psfm
