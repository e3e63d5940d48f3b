// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace psfm {

/// Tokens that bound what is under way. The source waits for one; publication gives it back.
/// Thread-safe.
class Admission {
  public:
    explicit Admission(int tokens) : free_(tokens) {}

    /// @return false when no token came free in time
    bool acquire_for(std::chrono::milliseconds timeout) {
        std::unique_lock lock(mutex_);
        if (!available_.wait_for(lock, timeout, [&] { return free_ > 0; })) return false;
        --free_;
        return true;
    }

    /// Whether somebody who asks now may go on at once.
    bool has_free() const {
        const std::lock_guard lock(mutex_);
        return free_ > 0;
    }

    void release(int tokens) {
        {
            const std::lock_guard lock(mutex_);
            free_ += tokens;
        }
        available_.notify_all();
    }

  private:
    mutable std::mutex mutex_;
    std::condition_variable available_;
    int free_;
};

}  // namespace psfm
