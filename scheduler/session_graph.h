// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tbb/task_arena.h>

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "graph/result.h"
#include "scheduler/admission.h"
#include "scheduler/committer.h"
#include "scheduler/messages.h"
#include "scheduler/run_session.h"
#include "scheduler/session_config.h"

namespace psfm {

/// The flow graph: extract -> sequence -> commit -> retrieve -> verify -> sequence -> commit ->
/// solve -> commit
/// -> merge -> commit -> publish. Topology is fixed; all state is in the committer and in
/// retrieval's index, each owned by one serial node. The first error stops the graph: nodes pass
/// nothing on any more.
class SessionGraph {
  public:
    struct Parts {
        SessionStore* store = nullptr;
        const StageOptions* options = nullptr;
        std::uint64_t seed = 0;
        Committer* committer = nullptr;
        SessionObserver* observer = nullptr;
        const std::atomic<bool>* stop = nullptr;
        Admission* photo_tokens = nullptr;
        Admission* image_tokens = nullptr;
        /// Images whose pairs are committed, by id: they are indexed for retrieval before the first
        /// photograph.
        std::vector<KnownImage> verified_images;
        std::string vocabulary_file;  ///< empty: trained from the session's own images
    };

    /// @param arena  where everything runs; outlives the graph
    /// @errors kNotFound, kDamaged (vocabulary file), errors of the store
    static Result<std::unique_ptr<SessionGraph>> create(const Parts& parts, tbb::task_arena& arena);
    ~SessionGraph();
    SessionGraph(const SessionGraph&) = delete;
    SessionGraph& operator=(const SessionGraph&) = delete;

    void put(const ArrivedPhoto& photo);
    void put(const ResumedImage& image);
    /// @param photos  how many were put
    void end_of_photos(std::uint64_t photos);
    /// Waits until nothing is under way. @return the first error, if there was one
    Result<void> wait();
    bool failed() const;

  private:
    struct Nodes;
    explicit SessionGraph(std::unique_ptr<Nodes> nodes);
    std::unique_ptr<Nodes> nodes_;
};

}  // namespace psfm
