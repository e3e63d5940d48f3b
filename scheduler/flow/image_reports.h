// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "scheduler/flow/outbox.h"
#include "scheduler/session/messages.h"
#include "scheduler/session/session_config.h"
#include "scheduler/session/session_state.h"

namespace psfm {

/// The committer's reports of images: what each waits for between its acceptance and the version
/// that takes account of it, and how long that took. They leave in order of arrival. An image gives
/// its token back when it is published, or earlier. Part of the committer: serial.
class ImageReports {
  public:
    /// REQUIRES: all of them outlive this
    ImageReports(const SessionConfig& config, SessionState& state, Outbox& outbox)
        : config_(&config), state_(&state), outbox_(&outbox) {}

    bool empty() const { return state_->pending.empty(); }
    bool all_verified() const;

    void accept(const Image& image, Clock::time_point arrival, double extract_ms = 0.0);
    /// An image of an earlier process, which has its pairs and is in no version.
    void take_up(const Image& image);
    /// REQUIRES: the image was accepted
    void verify(const VerifiedMessage& message, double cluster_ms);
    /// Images of the problem waited for so long.
    void solve(const ClusterProblem& problem, double milliseconds);
    /// What a version takes account of has its report.
    void publish(const MergeProblem& problem, double merge_ms, PublishMessage& publish);

  private:
    /// The next image may come in although this one is not published yet: what a version costs
    /// grows with the session, and so may the number of images that share it. All images of a batch
    /// do.
    void release_early(PendingImage& verified);

    const SessionConfig* config_;
    SessionState* state_;
    Outbox* outbox_;
};

}  // namespace psfm
