// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tbb/task_arena.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "graph/result.h"
#include "scheduler/flow/admission.h"
#include "scheduler/flow/committer.h"
#include "scheduler/flow/memory_budget.h"
#include "scheduler/flow/run_session.h"
#include "scheduler/front_end/front_end.h"
#include "scheduler/report/node_times.h"
#include "scheduler/session/messages.h"
#include "scheduler/session/session_config.h"

namespace psfm {

/// The flow graph: extract -> sequence -> commit -> retrieve -> verify -> sequence -> commit ->
/// solve -> commit
/// -> merge -> commit -> publish. Topology is fixed; all state is in the committer and in the
/// front end, each owned by one serial node. The first error stops the graph: nodes pass
/// nothing on any more.
class SessionGraph {
  public:
    struct Parts {
        const StageOptions* options = nullptr;
        FrontEnd* front_end = nullptr;
        Committer* committer = nullptr;
        SessionObserver* observer = nullptr;
        const std::atomic<bool>* stop = nullptr;
        const std::atomic<bool>* photo_came = nullptr;  ///< ends interim solves, as stop does
        Admission* photo_tokens = nullptr;
        Admission* image_tokens = nullptr;
        MemoryBudget* memory = nullptr;
        NodeTimes* times = nullptr;
        std::size_t committed_images = 0;  ///< whose pairs an earlier process has committed
    };

    /// Begins with a thread of its own, one of the arena's: the caller only hands on.
    /// @param arena  where everything runs; outlives the graph
    SessionGraph(const Parts& parts, tbb::task_arena& arena);
    ~SessionGraph();
    SessionGraph(const SessionGraph&) = delete;
    SessionGraph& operator=(const SessionGraph&) = delete;

    void put(const ArrivedPhoto& photo);
    void put(const ResumedImage& image);
    void put(const CatchUp& first);
    void put(const SourceIdle& idle);
    /// @param photos  how many were put
    void end_of_photos(std::uint64_t photos);
    /// Waits until nothing is under way. Nothing can be put afterwards.
    /// @return the first error, if there was one
    Result<void> wait();
    bool failed() const;

  private:
    struct Nodes;
    void finish();

    std::unique_ptr<Nodes> nodes_;
    std::thread thread_;
};

}  // namespace psfm
