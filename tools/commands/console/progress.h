// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "scheduler/flow/run_session.h"
#include "scheduler/report/event_log.h"
#include "tools/commands/console/time_left.h"

namespace psfm {

/// Shows a running session on stderr: one line that is rewritten with counts, rate and time left
/// when stderr is a terminal, and a line every ten seconds when it is none, where photographs are
/// waited for until nothing has happened for a minute; rejected photographs and changes of the
/// model on lines of their own in any case. Writes the log, too, and the note that `psfm status`
/// finds in the session.
class Progress final : public SessionObserver {
  public:
    /// @param expected  photographs that this run will look at; 0: unknown (a watched folder)
    Progress(std::filesystem::path session, std::size_t expected, std::unique_ptr<EventLog> log);
    ~Progress() override;
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void on_publish(const PublishMessage& publish) override;
    /// The run is over: the log's last line, and counts as the run ends with them.
    void on_end(const SessionRun& run);
    /// The log was asked for and could not be written to the end.
    bool log_failed() const { return log_ && !log_->good(); }

  private:
    /// Says so when the log can no longer be written, and when it can again.
    void write_log(const PublishMessage& publish);
    void on_settling(const SessionEvent& event);
    void on_solved(const SessionEvent& event);
    void say(const std::string& line);
    void show(const SessionCounts& counts);
    std::string line() const;
    double now() const;
    void tick();  // until it is stopped

    std::filesystem::path session_;
    std::size_t expected_;
    std::unique_ptr<EventLog> log_;
    bool log_is_behind_ = false;
    bool terminal_;
    bool line_open_ = false;
    int quiet_lines_ = 0;  // since something was published
    std::size_t done_ = 0;
    std::size_t settling_ = 0;  // models, of the last time that some began to
    std::map<std::uint32_t, std::uint32_t> unsettled_;  // of their clusters: how many images
    TimeLeft time_left_;
    SessionCounts counts_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::mutex mutex_;  // of all of the above: the clock has a thread of its own
    std::condition_variable wake_;
    bool over_ = false;
    std::thread clock_;
};

/// "1:05:09" or "7:35" for a number of seconds.
std::string format_duration(double seconds);

}  // namespace psfm
