// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>

namespace psfm {

inline std::chrono::steady_clock::duration seconds(double value) {
    return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(value));
}

/// When the next request of a connection is read: so many a second, after a start of as many as
/// come in a quarter of one. The generic cell rate algorithm (ITU-T I.371, annex A).
class RequestPace {
  public:
    using Clock = std::chrono::steady_clock;
    explicit RequestPace(double requests_per_second)
        : between_(seconds(1.0 / requests_per_second)) {}

    /// A request has come. @return how long the connection has to wait; zero: not at all
    Clock::duration next(Clock::time_point now) {
        constexpr auto kStart = std::chrono::milliseconds(250);  // Guard: a page's first requests
        due_ = std::max(due_, now - kStart) + between_;
        return std::max(due_ - now, Clock::duration::zero());
    }

  private:
    Clock::duration between_;
    Clock::time_point due_ = Clock::time_point::min();
};

}  // namespace psfm
