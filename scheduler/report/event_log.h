// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "graph/result.h"
#include "scheduler/report/node_times.h"
#include "scheduler/session/messages.h"

namespace psfm {

/// The log of a session as JSON lines (docs/commands.md, "The log"): an "image" event for every
/// image once a published version takes account of it, "rejected", "join", "split", "reset",
/// "transfer" and "solve" events as they happen, and at the end of a run "nodes", what the nodes of
/// the flow graph did. Every line is written at once, so that the log can be followed; what cannot
/// be (a full disk) is kept, and written when it can. Appends. Not thread-safe.
class EventLog {
  public:
    /// @errors kIo, kNoSpace (the file cannot be opened for writing)
    static Result<std::unique_ptr<EventLog>> open(const std::filesystem::path& file);

    void write(const PublishMessage& publish);
    void write(const GraphUsage& usage);
    /// All lines are in the file.
    bool good() const { return unwritten_.empty() && !lost_; }
    const std::filesystem::path& file() const { return file_; }

    ~EventLog();
    EventLog(const EventLog&) = delete;
    EventLog& operator=(const EventLog&) = delete;

  private:
    EventLog(std::filesystem::path file, int descriptor)
        : file_(std::move(file)), descriptor_(descriptor) {}
    void append(const std::string& lines);
    /// Writes as much of what is unwritten as fits.
    void flush();

    std::filesystem::path file_;
    int descriptor_;
    std::string unwritten_;  // from where in a line it may begin
    bool lost_ = false;      // more lines than are kept
};

/// One event or image as a line of JSON, without the line's end.
std::string log_line(const ImageReport& image, const SessionCounts& counts);
std::string log_line(const SessionEvent& event);
std::string log_line(const GraphUsage& usage);
const char* name_of(SessionEvent::Kind kind);

}  // namespace psfm
