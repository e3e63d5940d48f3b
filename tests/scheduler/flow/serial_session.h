// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "scheduler/flow/committer.h"
#include "tests/storage/test_session.h"
#include "tests/synthetic/scene.h"

namespace psfm::test {

/// A new session's store, or that of one that the folder has.
std::unique_ptr<SessionStore> open_store(const testing::TemporaryFolder& folder);

/// A session of a synthetic scene: one message after the other, through the committer and the real
/// stages behind it, with verified pairs instead of photographs.
class SerialSession {
  public:
    /// Goes on where the store ends, and finishes what an earlier process left.
    /// @param pairs  all of them; an image brings those with earlier ones
    /// @param clustering  by default parts of a few images, as these scenes have, stay parts
    /// @param policy  when clusters are solved how
    /// REQUIRES: scene, pairs, and the image tokens of the pace outlive the session
    SerialSession(SessionStore& store, const synthetic::SyntheticScene& scene,
                  const std::vector<VerifiedPairPtr>& pairs, bool deterministic = true,
                  const ClusteringOptions& clustering = {.join_below = 0},
                  const SolvePolicy& policy = {}, const CommitterPace& pace = {});

    static constexpr std::size_t kAll = static_cast<std::size_t>(-1);
    /// Takes the next image through all stages; or handles so many messages of it only, like a
    /// process that is killed then. @return whether it got to the end
    bool add_image(std::size_t messages = kAll);
    /// The source has no photograph at present.
    void idle();
    /// No image will follow: settles the models.
    void end();
    /// Solves take until the next release_solves(); messages that follow overtake them.
    void hold_solves() { holds_solves_ = true; }
    /// @param last_first  in the opposite order
    void release_solves(bool last_first = false);
    /// Those that are held end; what follows is held again.
    void release_held();
    /// The solve of this cluster says that its model shows two places, the first one of so many
    /// equal parts of its images and the rest; the others say what they do. Solves that follow are
    /// held.
    void release_showing_two_places(ClusterId cluster, std::size_t parts = 2);
    /// Solves fail from now on, or do not.
    void fail_solves(bool fail = true) { fails_solves_ = fail; }
    const std::vector<SolveMessage>& held() const { return held_; }
    std::size_t held_solves() const { return held_.size(); }
    /// Merges take until release_merge(), which lets the one in flight end.
    void hold_merges() { holds_merges_ = true; }
    void release_merge();
    /// What merges say that they took from now on.
    void merges_take(double milliseconds) { merge_ms_ = milliseconds; }

    const SessionState& state() const { return committer_->state(); }
    const std::vector<SessionEvent>& events() const { return events_; }
    /// Indices of reported images, in order, counted from 1.
    const std::vector<std::uint32_t>& reported() const { return reported_; }
    /// Image tokens that have been given back.
    std::uint32_t released() const { return released_; }
    /// Images that had a place when each of these was reported.
    const std::vector<std::uint32_t>& placed_when_reported() const { return placed_when_reported_; }

  private:
    bool run(std::vector<CommitInput> messages, std::size_t at_most);
    CommitInput verified(ImageId image) const;
    CommitInput solved(const SolveMessage& solve) const;
    CommitInput merged(const MergeMessage& merge);

    const synthetic::SyntheticScene* scene_;
    const std::vector<VerifiedPairPtr>* pairs_;
    StageOptions options_;
    std::unique_ptr<Committer> committer_;
    std::vector<SessionEvent> events_;
    std::vector<std::uint32_t> reported_;
    std::vector<std::uint32_t> placed_when_reported_;
    std::uint64_t photos_ = 0;
    std::uint32_t released_ = 0;
    bool fails_solves_ = false;
    bool holds_solves_ = false;
    std::vector<SolveMessage> held_;
    bool holds_merges_ = false;
    std::optional<MergeMessage> held_merge_;
    double merge_ms_ = 0.0;
};

}  // namespace psfm::test
