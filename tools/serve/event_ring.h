// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace psfm {

/// The latest events of a server, each with a number, for streams that are gone on with where they
/// broke off. Thread-safe.
class EventRing {
  public:
    struct Event {
        std::uint64_t number = 0;
        std::string kind;
        std::string data;  ///< one line
    };

    /// @param start  tells this server from the one before it
    /// @param most   events that are kept
    explicit EventRing(std::string start, std::size_t most = 4096)
        : start_(std::move(start)), most_(most) {}

    void publish(std::string kind, std::string data);
    /// Called after each publish(), on its thread.
    void on_publish(std::function<void()> wake);

    /// Events after `number`. @return nothing when some of these are not kept any more
    std::optional<std::vector<Event>> after(std::uint64_t number) const;
    std::uint64_t last() const;

    /// As it stands in a stream (HTML, section 9.2), its id "<start>-<number>".
    std::string text_of(const Event& event) const;
    std::string id_of(std::uint64_t number) const;
    /// @return nothing for what is no id of this server
    std::optional<std::uint64_t> number_of(const std::string& id) const;

  private:
    const std::string start_;
    const std::size_t most_;
    mutable std::mutex mutex_;
    std::deque<Event> events_;
    std::uint64_t last_ = 0;
    std::function<void()> wake_;
};

/// What one watcher is sent of a ring's events, in order: text as it stands in the stream.
class EventStream {
  public:
    /// @param events   outlives this
    /// @param last_id  of the last event that the watcher has; empty: none
    EventStream(const EventRing& events, const std::string& last_id);

    /// How the stream begins.
    const std::string& beginning() const { return beginning_; }
    /// What has happened since the last call; empty: nothing.
    std::string next();

  private:
    const EventRing* events_;
    std::uint64_t number_ = 0;
    std::string beginning_ = "retry: 2000\n";
};

}  // namespace psfm
