// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>

namespace psfm::testing {

/// Where threads wait until two of them at least have come, or ten seconds are over: what they do
/// next, they do at once. Relaxed: it orders nothing that they do, so that ThreadSanitizer sees a
/// race made on purpose. Thread-safe.
class Meeting {
  public:
    void wait() {
        present_.fetch_add(1, std::memory_order_relaxed);
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
        while (present_.load(std::memory_order_relaxed) < 2 &&
               std::chrono::steady_clock::now() < end) {
        }
    }

  private:
    std::atomic<int> present_{0};
};

}  // namespace psfm::testing
