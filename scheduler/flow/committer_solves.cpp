// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The committer and the solves: how they begin, and what becomes of their solutions.
#include <algorithm>
#include <span>
#include <utility>

#include "scheduler/flow/committer.h"
#include "scheduler/flow/make_problems.h"
#include "scheduler/report/describe_events.h"
#include "scheduler/session/encode_state.h"

namespace psfm {

Result<std::shared_ptr<const ClusterProblem>> Committer::problem_of(const ClusterEntry& entry,
                                                                    bool settle) {
    const auto read = state_.photographs.keypoints.use(state_.clusters.images_of(entry), *store_);
    if (!read.ok()) return read.error();
    const auto awake = state_.models.use(std::span(&entry.id, 1), state_.clusters, *store_);
    if (!awake.ok()) return awake.error();
    return make_cluster_problem(state_, config_, options_.solve, entry, settle);
}

Result<void> Committer::start_solves(const std::vector<const ClusterEntry*>& clusters, bool settle,
                                     CommitOutput& output) {
    for (const ClusterEntry* entry : clusters) {
        auto problem = problem_of(*entry, settle);
        if (!problem.ok()) return problem.error();
        const bool is_interim = settle && !config_.deterministic && photos_before_rest_ &&
                                photos_expected_ != photos_seen_;
        output.solves.push_back({*std::move(problem), is_interim});
        ++solving_;
    }
    // Those that a cluster could not place are tried elsewhere (unplaced_images).
    state_.photographs.keypoints.release([&](ImageId image) {
        if (index_of(image) >= state_.verified) return false;
        const ClusterEntry& entry = state_.clusters.of(image);
        return entry.phase == ClusterPhase::kClean && entry.published.model &&
               entry.published.model->find(image) != nullptr;
    });
    return {};
}

Result<void> Committer::on(const SolvedMessage& message, CommitOutput& /*output*/) {
    --solving_;
    // Expected: cancelled, since a photograph came first; it settles once none has come for long
    if (!message.solution->ok() && message.solution->error().code == ErrorCode::kCancelled) {
        --settling_;
        state_.clusters.put_off(message.problem->cluster);
        return {};
    }
    if (!config_.deterministic) {
        const auto taken = take_solution(message);
        return taken.ok() ? Result<void>() : taken.error();
    }
    // Which of several ends first depends on the machine, and what one says of places on which.
    solved_.push_back(message);
    if (solving_ > 0) return {};
    std::vector<SolvedMessage> solved = std::exchange(solved_, {});
    std::ranges::sort(solved, {}, [](const SolvedMessage& m) { return m.problem->cluster; });
    bool others_changed = false;
    for (const SolvedMessage& one : solved) {
        // A process that dies here has stored what one solution said of places, and solves the
        // others again with that: so does one that lives.
        if (others_changed && !one.problem->settle) {
            give_up(one);
            continue;
        }
        const auto taken = take_solution(one);
        if (!taken.ok()) return taken.error();
        others_changed |= *taken;
    }
    return {};
}

void Committer::give_up(const SolvedMessage& message) {
    state_.clusters.give_up(message.problem->cluster);
    if (!message.solution->ok()) return;
    outbox_.events.push_back(describe_solve(*message.problem, *message.solution,
                                            message.solution->value(),
                                            /*published=*/false));
}

void Committer::fail(const SolvedMessage& message) {
    if (message.problem->settle) {
        --settling_;
    } else {
        changed_ = true;  // images that it does not place are reported with the next version
    }
    state_.clusters.fail(*message.problem, message.solution->error());
    outbox_.events.push_back(describe_solve(*message.problem, *message.solution, ClusterSolution{},
                                            /*published=*/false));
}

Result<bool> Committer::take_solution(const SolvedMessage& message) {
    // Expected: not enough memory, or a library's exception; run_session tells of it at its end
    if (!message.solution->ok()) {
        fail(message);
        return false;
    }
    ClusterSolution solution = message.solution->value();
    if (message.problem->settle) --settling_;
    const SolveStatistics& statistics = solution.statistics;
    switch (statistics.kind) {
        case SolveKind::kNew:
            ++state_.counts.solves_new;
            break;
        case SolveKind::kExtend:
            ++state_.counts.solves_extend;
            break;
        case SolveKind::kTransfer:
            ++state_.counts.solves_transfer;
            break;
        case SolveKind::kSettle:
            ++state_.counts.solves_settle;
            break;
        case SolveKind::kTooSmall:
            break;
    }
    reports_.solve(*message.problem, statistics.milliseconds);
    if (statistics.reset) {
        ++state_.counts.resets;
        outbox_.tell(describe_reset(*message.problem, solution, state_.photographs.images), state_);
    }
    if (auto cameras = describe_cameras(*message.problem, solution, state_.photographs.images))
        outbox_.tell(*std::move(cameras), state_);
    const ClusterEntry* entry = state_.clusters.finish(*message.problem, solution);
    outbox_.events.push_back(
        describe_solve(*message.problem, *message.solution, solution, entry != nullptr));
    changed_ = true;
    if (entry == nullptr) {
        const auto edit = keeper_.separate(*message.problem, *message.solution);
        if (!edit.ok()) return edit.error();
        if (!changes_clusters(*edit)) return false;
        const auto stored = store_->commit_clusters(*edit);
        return stored.ok() ? Result<bool>(true) : stored.error();
    }
    StoredSolution stored_solution;
    stored_solution.cluster = entry->id;
    stored_solution.revision = entry->published.revision;
    stored_solution.model = entry->published.model;
    stored_solution.state_json = encode_solve_state({solution.state, entry->published.settled});
    stored_solution.succession = std::move(solution.succession);
    // What is found of places may change the clusters, and may be the end of this one.
    StoredCluster own = keeper_.stored(*entry);
    auto edit = keeper_.separate(*message.problem, *message.solution);
    if (!edit.ok()) return edit.error();
    const bool changes = changes_clusters(*edit);
    std::erase_if(edit->changed, [&](const StoredCluster& c) { return c.id == own.id; });
    const auto still = state_.clusters.entries().find(own.id);
    if (still != state_.clusters.entries().end()) own = keeper_.stored(still->second);
    const auto stored = store_->commit_solution(stored_solution, own, *edit);
    return stored.ok() ? Result<bool>(changes) : stored.error();
}

}  // namespace psfm
