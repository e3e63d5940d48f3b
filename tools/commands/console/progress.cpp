// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "graph/wording.h"
#include "tools/report/run_state.h"

namespace psfm {
namespace {

/// Format: of what is no terminal: a log grows by some KB an hour.
constexpr int kSecondsPerLine = 10;
// Format: a minute of them: a server that waits for photographs for days says no more.
constexpr int kQuietLines = 6;

}  // namespace

std::string format_duration(double seconds) {
    const auto total = static_cast<long>(std::lround(std::max(seconds, 0.0)));
    char text[32];
    if (total >= 3600) {
        std::snprintf(text, sizeof(text), "%ld:%02ld:%02ld", total / 3600, total / 60 % 60,
                      total % 60);
    } else {
        std::snprintf(text, sizeof(text), "%ld:%02ld", total / 60, total % 60);
    }
    return text;
}

Progress::Progress(std::filesystem::path session, std::size_t expected,
                   std::unique_ptr<EventLog> log)
    : session_(std::move(session)),
      expected_(expected),
      log_(std::move(log)),
      terminal_(isatty(STDERR_FILENO) == 1),
      time_left_(expected) {
    clock_ = std::thread([this] { tick(); });
}

Progress::~Progress() {
    {
        const std::lock_guard lock(mutex_);
        over_ = true;
    }
    wake_.notify_all();
    clock_.join();
    remove_run_state(session_);
    if (line_open_) std::cerr << '\n';
}

double Progress::now() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::tick() {
    std::unique_lock lock(mutex_);
    std::string last_line = line();
    for (int second = 0; !over_; ++second) {
        write_run_state(session_, {getpid(), now(), done_, expected_, time_left_.rate(now()),
                                   time_left_.is_settling(), time_left_.seconds(now())});
        const bool works = expected_ > 0 || !unsettled_.empty();
        if (!terminal_ && second > 0 && second % kSecondsPerLine == 0 &&
            (works || quiet_lines_++ < kQuietLines)) {
            if (std::string next = line(); next != last_line) {
                say(next);
                last_line = std::move(next);
            }
        }
        wake_.wait_for(lock, std::chrono::seconds(1), [&] { return over_; });
    }
}

void Progress::on_publish(const PublishMessage& publish) {
    const std::lock_guard lock(mutex_);
    quiet_lines_ = 0;
    write_log(publish);
    done_ += publish.images.size();
    done_ += static_cast<std::size_t>(
        std::ranges::count(publish.events, SessionEvent::Kind::kRejected, &SessionEvent::kind));
    time_left_.on_photos(now(), done_);  // before models that begin to settle with the last ones
    if (!publish.images.empty()) settling_ = 0;  // a watched folder goes on after it has settled
    for (const SessionEvent& event : publish.events) {
        switch (event.kind) {
            case SessionEvent::Kind::kRejected:
                say("rejected " + event.text);  // which names the photograph
                break;
            case SessionEvent::Kind::kRemark:
                say("note " + event.text);
                break;
            case SessionEvent::Kind::kReset:
                say("reset: " + event.text);
                break;
            case SessionEvent::Kind::kPlaces:
                say("places: " + event.text);
                break;
            case SessionEvent::Kind::kCameras:
                say("cameras: " + event.text);
                break;
            case SessionEvent::Kind::kJoin:
            case SessionEvent::Kind::kSplit:
            case SessionEvent::Kind::kTransfer:
            case SessionEvent::Kind::kAdopt:
                if (terminal_) say(event.text);
                break;
            case SessionEvent::Kind::kSettle:
                if (terminal_) say(event.text);
                on_settling(event);
                break;
            case SessionEvent::Kind::kSolve:
                on_solved(event);
                break;
        }
    }
    show(publish.counts);
}

void Progress::on_settling(const SessionEvent& event) {
    settling_ = event.clusters.size();
    unsettled_.clear();
    std::size_t images = 0;
    for (std::size_t i = 0; i < event.clusters.size(); ++i) {
        unsettled_[event.clusters[i]] = event.cluster_images[i];
        images += event.cluster_images[i];
    }
    time_left_.on_settling(now(), images);
}

void Progress::on_solved(const SessionEvent& event) {
    for (const std::uint32_t cluster : event.clusters) {
        if (const auto found = unsettled_.find(cluster); found != unsettled_.end()) {
            time_left_.on_settled(now(), found->second);
            unsettled_.erase(found);
        }
    }
}

void Progress::show(const SessionCounts& counts) {
    counts_ = counts;
    if (!terminal_) return;
    std::cerr << "\r\x1b[K" << line() << std::flush;
    line_open_ = true;
}

void Progress::write_log(const PublishMessage& publish) {
    if (!log_) return;
    log_->write(publish);
    if (log_->good() == log_is_behind_) {
        log_is_behind_ = !log_->good();
        say("psfm: the log " + log_->file().string() +
            (log_is_behind_ ? " cannot be written to; is the disk full? What belongs there is kept "
                              "for as long as this process lives"
                            : " is complete again"));
    }
}

void Progress::on_end(const SessionRun& run) {
    const std::lock_guard lock(mutex_);
    if (log_) log_->write(run.usage);
    show(run.counts);
}

void Progress::say(const std::string& line) {
    std::cerr << (line_open_ ? "\r\x1b[K" : "") << line << '\n';
    line_open_ = false;
}

std::string Progress::line() const {
    std::string line = std::to_string(done_);
    if (expected_ > 0) line.append("/").append(std::to_string(expected_));
    line += std::max(done_, expected_) == 1 ? " photograph" : " photographs";
    char text[160];
    std::snprintf(text, sizeof(text),
                  ", %u of %u images placed, %u waiting, %s in %s, %.2f images/s", counts_.placed,
                  counts_.images, counts_.waiting, counted(counts_.clusters, "cluster").c_str(),
                  counted(counts_.effective_clusters, "part").c_str(), time_left_.rate(now()));
    line += text;
    if (settling_ > 0) {
        line += ", " + std::to_string(settling_ - unsettled_.size()) + " of " +
                counted(settling_, "model") + " settled";
    }
    if (const auto left = time_left_.seconds(now()); left && (done_ < expected_ || settling_ > 0))
        line += ", " + format_duration(*left) + " left";
    return line;
}

}  // namespace psfm
