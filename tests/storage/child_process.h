// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <string>
#include <vector>

namespace psfm::testing {

/// session_process in a process of its own; killed at the end when it still runs.
class ChildProcess {
  public:
    explicit ChildProcess(const std::vector<std::string>& arguments);
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    pid_t pid() const { return pid_; }
    /// The next line of its output, without its end; empty at the end of the output.
    std::string read_line();
    /// As a power cut would: SIGKILL.
    void kill();
    /// Ends its input, waits. @return its exit status, -1 when it was killed
    int finish();

  private:
    int wait();
    pid_t pid_ = -1;
    int input_ = -1;
    std::FILE* output_ = nullptr;
};

}  // namespace psfm::testing
