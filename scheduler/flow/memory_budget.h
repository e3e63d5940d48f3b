// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>

namespace psfm {

/// Bytes that photographs which are being read may take together. One that would take more than
/// there are is read alone. Thread-safe.
class MemoryBudget {
  public:
    explicit MemoryBudget(std::size_t bytes) : bytes_(bytes) {}

    /// @return false when not enough came free in time; else release() as many
    bool acquire_for(std::size_t bytes, std::chrono::milliseconds timeout) {
        std::unique_lock lock(mutex_);
        const auto fits = [&] {
            return taken_ == 0 || (taken_ <= bytes_ && bytes <= bytes_ - taken_);
        };
        if (!available_.wait_for(lock, timeout, fits)) return false;
        taken_ += bytes;
        return true;
    }

    void release(std::size_t bytes) {
        {
            const std::lock_guard lock(mutex_);
            taken_ -= std::min(bytes, taken_);
        }
        available_.notify_all();
    }

    std::size_t taken() const {
        const std::lock_guard lock(mutex_);
        return taken_;
    }

  private:
    mutable std::mutex mutex_;
    std::condition_variable available_;
    std::size_t bytes_;
    std::size_t taken_ = 0;
};

}  // namespace psfm
