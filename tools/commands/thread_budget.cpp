// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/thread_budget.h"

#include <dlfcn.h>
#include <tbb/global_control.h>

#include <opencv2/core/utility.hpp>
#include <thread>

namespace psfm {

struct ThreadBudget::Control {
    explicit Control(std::size_t threads)
        : limit(tbb::global_control::max_allowed_parallelism, threads) {}
    tbb::global_control limit;
};

ThreadBudget::ThreadBudget(int threads) {
    const unsigned workers = threads > 0 ? static_cast<unsigned>(threads)
                                         : std::max(1U, std::thread::hardware_concurrency());
    // One more than the workers: the thread that feeds the session's graph, which mostly sleeps.
    control_ = std::make_unique<Control>(workers + 1);
    cv::setNumThreads(1);
    // Ceres and SuiteSparse call whichever BLAS is installed; OpenBLAS starts threads unless told
    // not to.
    using SetThreads = void (*)(int);
    if (auto* set_threads =
            reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads")))
        set_threads(1);
}

ThreadBudget::~ThreadBudget() = default;

}  // namespace psfm
