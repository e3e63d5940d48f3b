// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "graph/result.h"
#include "scheduler/front_end/front_end.h"
#include "scheduler/front_end/salvage.h"
#include "scheduler/report/node_times.h"
#include "scheduler/session/messages.h"
#include "scheduler/session/session_config.h"
#include "scheduler/session/weak_model.h"
#include "stages/features/photographs/photo_file.h"
#include "storage/session/session_store.h"

namespace psfm {

/// Who wants to hear what a session does. Called from one thread at a time.
class SessionObserver {
  public:
    virtual ~SessionObserver() = default;
    virtual void on_publish(const PublishMessage& publish) = 0;
};

/// Where photographs come from. Called from the thread of run_session.
class PhotoSource {
  public:
    virtual ~PhotoSource() = default;
    enum class Next : std::uint8_t { kPhoto, kLater, kEnd };
    /// kPhoto: `photo` is the next one; kLater: none at the moment (a watched folder); kEnd: none
    /// will follow.
    virtual Next next(PhotoFile& photo) = 0;
};

/// A fixed list.
class PhotoList final : public PhotoSource {
  public:
    explicit PhotoList(std::vector<PhotoFile> photos) : photos_(std::move(photos)) {}
    Next next(PhotoFile& photo) override {
        if (position_ == photos_.size()) return Next::kEnd;
        photo = photos_[position_++];
        return Next::kPhoto;
    }

  private:
    std::vector<PhotoFile> photos_;
    std::size_t position_ = 0;
};

struct SessionRun {
    bool interrupted = false;  ///< `stop` was set before everything was done
    SessionCounts counts;
    std::vector<std::pair<std::string, WaitReason>>
        waiting;                       ///< names of images in no model, with the reason
    std::vector<WeakModel> weak;       ///< models that are not to be trusted far
    GraphUsage usage;                  ///< what the nodes of the flow graph did
    std::vector<std::string> remarks;  ///< RestoredSession::remarks, and what was not solved
};

/// Takes a session through the flow graph (docs/architecture.md) until the source ends and
/// everything is solved, or `stop` is set: then commits under way are finished, and the rest is
/// left for the next run. Photographs that the session has (by name), or has rejected for what is
/// in them, are skipped where their files have not changed (compare_with_session says more of
/// them).
/// @errors those of the store and of the front end (vocabulary file, database); the store stays
/// consistent
/// @param salvage  a damaged session that images and pairs are taken over from; null: none
/// @param extract  who reads photographs; empty: run_features, in this process
Result<SessionRun> run_session(SessionStore& store, const SessionConfig& config,
                               const ExecutionOptions& execution, PhotoSource& photos,
                               SessionObserver& observer, const std::atomic<bool>& stop,
                               Salvage* salvage = nullptr, const PhotoExtractor& extract = {});

}  // namespace psfm
