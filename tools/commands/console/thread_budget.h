// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

namespace psfm {

/// The one thread budget of the program: holds TBB to it, and keeps OpenCV and BLAS from threads of
/// their own.
class ThreadBudget {
  public:
    /// @param threads  0: as many as there are cores
    explicit ThreadBudget(int threads);
    ~ThreadBudget();
    ThreadBudget(const ThreadBudget&) = delete;
    ThreadBudget& operator=(const ThreadBudget&) = delete;

  private:
    struct Control;
    std::unique_ptr<Control> control_;
};

}  // namespace psfm
