// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <cstddef>
#include <iostream>

namespace psfm {

/// "done/count what" on a line of stderr that is rewritten, when that is a terminal. Not
/// thread-safe.
class CountLine {
  public:
    CountLine(const char* what, std::size_t count) : what_(what), count_(count) {}
    CountLine(const CountLine&) = delete;
    CountLine& operator=(const CountLine&) = delete;
    ~CountLine() {
        if (terminal_) std::cerr << "\r\x1b[K" << std::flush;
    }
    void advance() {
        ++done_;
        if (terminal_) std::cerr << "\r\x1b[K" << done_ << '/' << count_ << what_ << std::flush;
    }

  private:
    const char* what_;
    std::size_t count_;
    std::size_t done_ = 0;
    bool terminal_ = isatty(STDERR_FILENO) == 1;
};

}  // namespace psfm
