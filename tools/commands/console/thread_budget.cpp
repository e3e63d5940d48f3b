// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/thread_budget.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <opencv2/core/parallel/parallel_backend.hpp>
#include <opencv2/core/utility.hpp>
#include <thread>
#include <utility>

#include "stages/algorithms/math/one_blas_thread.h"

namespace psfm {
namespace {

/// OpenCV's loops in the arena of the thread that calls them: among the session's own tasks, where
/// threads are free. The backend that Debian's OpenCV comes with has an arena of its own, to which
/// TBB lends nobody while the session's asks for all.
class CallersArena final : public cv::parallel::ParallelForAPI {
  public:
    explicit CallersArena(int threads) : threads_(threads) {}

    void parallel_for(int tasks, FN_parallel_for_body_cb_t body, void* data) override {
        // A waiting thread must not begin another image in the middle of this one.
        tbb::this_task_arena::isolate([&] {
            using Range = tbb::blocked_range<int>;
            tbb::parallel_for(Range(0, tasks),
                              [&](const Range& range) { body(range.begin(), range.end(), data); });
        });
    }
    int getThreadNum() const override { return tbb::this_task_arena::current_thread_index(); }
    int getNumThreads() const override { return threads_; }
    int setNumThreads(int threads) override { return std::exchange(threads_, threads); }
    const char* getName() const override { return "psfm"; }

  private:
    int threads_;
};

}  // namespace

struct ThreadBudget::Control {
    explicit Control(std::size_t threads)
        : limit(tbb::global_control::max_allowed_parallelism, threads) {}
    tbb::global_control limit;
};

ThreadBudget::ThreadBudget(int threads) {
    const unsigned workers = threads > 0 ? static_cast<unsigned>(threads)
                                         : std::max(1U, std::thread::hardware_concurrency());
    // One more than arenas have slots for, since TBB starts a worker in any case for what is
    // enqueued where it is allowed none.
    control_ = std::make_unique<Control>(workers + 1);
    cv::parallel::setParallelForBackend(std::make_shared<CallersArena>(static_cast<int>(workers)),
                                        false);
    cv::setNumThreads(static_cast<int>(workers));
    keep_blas_on_one_thread();
}

ThreadBudget::~ThreadBudget() = default;

}  // namespace psfm
