// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "graph/result.h"
#include "scheduler/flow/admission.h"
#include "scheduler/flow/cluster_keeper.h"
#include "scheduler/flow/image_reports.h"
#include "scheduler/flow/intake.h"
#include "scheduler/flow/outbox.h"
#include "scheduler/session/messages.h"
#include "scheduler/session/session_config.h"
#include "scheduler/session/session_state.h"

namespace psfm {

/// What one message makes the commit node send on.
struct CommitOutput {
    std::vector<AcceptedImagePtr> accepted;  ///< to retrieval, in order of acceptance
    std::vector<SolveMessage> solves;
    std::optional<MergeMessage> merge;
    std::optional<PublishMessage> publish;
};

/// What the machine allows, and changes no result of a deterministic session.
struct CommitterPace {
    /// See ResidentKeypoints and ResidentModels: so many bytes for each.
    std::size_t idle_bytes = ExecutionOptions{}.idle_bytes;
    /// Models that settle side by side in a session that is not deterministic; the others have
    /// their points and keypoints in the store meanwhile. Raised: more memory; below the number of
    /// threads: some have nothing to do.
    std::size_t settle_at_once = 8;
    /// See ExecutionOptions.
    double rest_per_merge = ExecutionOptions{}.rest_per_merge;
    /// Null: whatever is quiet counts as idle.
    const Admission* image_tokens = nullptr;
};

/// The one writer of a session: applies what the stages found to the state, stores it (the
/// commit points of docs/design.md), and decides what is solved, merged and published next. Serial;
/// no TBB in here, so that the whole life of a session can be tested message by message.
///
/// REQUIRES of the caller: Extracted messages in order of sequence, Verified messages in order of
/// image id.
class Committer {
  public:
    /// @param pace  what it watches outlives this
    Committer(SessionStore& store, SessionConfig config, const StageOptions& options,
              SessionState state, const CommitterPace& pace = {});
    Committer(const Committer&) = delete;
    Committer& operator=(const Committer&) = delete;

    /// @errors those of the store: the session cannot go on, and everything acknowledged is safe.
    /// After an error every further message is ignored.
    Result<CommitOutput> handle(const CommitInput& message);

    const SessionState& state() const { return state_; }

  private:
    Result<void> on(const CatchUp& message, CommitOutput& output);
    Result<void> on(const ExtractedMessage& message, CommitOutput& output);
    Result<void> on(const ResumedImage& message, CommitOutput& output);
    Result<void> on(const VerifiedMessage& message, CommitOutput& output);
    Result<void> on(const SolvedMessage& message, CommitOutput& output);
    Result<void> on(const MergedMessage& message, CommitOutput& output);
    Result<void> on(const SourceIdle& message, CommitOutput& output);
    Result<void> on(const EndOfPhotos& message, CommitOutput& output);

    /// A solution becomes its cluster's, and is committed. @return whether what it says of places
    /// has changed clusters @errors those of the store
    Result<bool> take_solution(const SolvedMessage& message);
    /// A solve failed: nothing is stored, so that the next process tries it again.
    void fail(const SolvedMessage& message);
    /// A solution is left out of account: its cluster is solved again, from what the store has.
    void give_up(const SolvedMessage& message);
    /// @errors those of the store
    Result<void> advance(CommitOutput& output);
    /// @errors those of the store
    Result<std::shared_ptr<const ClusterProblem>> problem_of(const ClusterEntry& entry,
                                                             bool settle);
    /// unplaced_images(), with their keypoints. @errors those of the store
    Result<std::vector<UnplacedImage>> images_to_adopt();
    /// What merging looks at is awake in it. @errors those of the store
    Result<MergeMessage> problem_of_merge();
    /// @errors those of the store
    Result<void> start_solves(const std::vector<const ClusterEntry*>& clusters, bool settle,
                              CommitOutput& output);
    /// What becomes of a session at rest to which no photograph comes: what was held apart is
    /// joined, once nothing is, all settles, and then what was kept apart is asked once more.
    /// @errors those of the store
    Result<void> conclude(CommitOutput& output);
    /// All that has not settled is to settle, the largest model first.
    void begin_settling();
    /// What is to settle does, as much of it as may at once. Deterministic sessions settle all from
    /// one and the same state. @errors those of the store
    Result<void> go_on_settling(CommitOutput& output);
    /// Photographs are waiting, and may come in: so a quiet moment is short.
    bool more_to_come() const;
    void count(const Scene& scene);

    SessionStore* store_;
    SessionConfig config_;
    StageOptions options_;
    SessionState state_;
    Outbox outbox_;
    ImageReports reports_;
    Intake intake_;
    ClusterKeeper keeper_;
    CommitterPace pace_;
    std::uint32_t coalesced_before_ = 0;  // solves, in earlier processes
    std::uint64_t photos_seen_ = 0;
    std::optional<std::uint64_t> photos_before_idle_;  // none: photographs have been waiting always
    std::optional<std::uint64_t> photos_before_rest_;  // none: none has been awaited for long
    std::optional<std::uint64_t> photos_expected_;     // known once no photograph will follow
    bool merging_ = false;                             // one merge in flight at most
    Clock::time_point next_version_;                   // not before, while there is other work
    bool changed_ = false;                             // something is to be merged and published
    bool catching_up_ = false;                         // an image token is held for that
    bool settle_first_ = false;                        // an earlier process was settling
    std::deque<ClusterId> to_settle_;                  // taken from the table, and not begun yet
    std::size_t settling_ = 0;                         // begun, and not solved yet
    std::size_t solving_ = 0;                          // solves in flight
    std::vector<SolvedMessage> solved_;  // deterministic: those of them that wait for the others
    bool failed_ = false;
};

}  // namespace psfm
