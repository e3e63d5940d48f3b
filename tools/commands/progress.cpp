// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/progress.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <iostream>

namespace psfm {

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

Progress::Progress(std::size_t expected, std::unique_ptr<EventLog> log)
    : expected_(expected), log_(std::move(log)), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    if (line_open_) std::cerr << '\n';
}

void Progress::on_publish(const PublishMessage& publish) {
    write_log(publish);
    done_ += publish.images.size();
    if (!publish.images.empty()) settling_ = 0;  // a watched folder goes on after it has settled
    for (const SessionEvent& event : publish.events) {
        switch (event.kind) {
            case SessionEvent::Kind::kRejected:
                ++done_;
                say("rejected " + event.text);  // which names the photograph
                break;
            case SessionEvent::Kind::kReset:
                say("reset: " + event.text);
                break;
            case SessionEvent::Kind::kPlaces:
                say("places: " + event.text);
                break;
            case SessionEvent::Kind::kJoin:
            case SessionEvent::Kind::kSplit:
            case SessionEvent::Kind::kTransfer:
            case SessionEvent::Kind::kAdopt:
                if (terminal_) say(event.text);
                break;
            case SessionEvent::Kind::kSettle:
                if (terminal_) say(event.text);
                settling_ = event.clusters.size();
                settled_before_ = publish.counts.solves_settle;
                break;
            case SessionEvent::Kind::kSolve:
                break;
        }
    }
    if (terminal_) show(publish.counts);
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
    if (log_) log_->write(run.usage);
}

void Progress::say(const std::string& line) {
    std::cerr << (line_open_ ? "\r\x1b[K" : "") << line << '\n';
    line_open_ = false;
}

void Progress::show(const SessionCounts& counts) {
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    const double rate = seconds > 0.0 ? static_cast<double>(done_) / seconds : 0.0;
    std::string line = std::to_string(done_);
    if (expected_ > 0) line.append("/").append(std::to_string(expected_));
    char text[160];
    std::snprintf(text, sizeof(text),
                  " images, %u placed, %u waiting, %u clusters in %u parts, %.2f images/s",
                  counts.placed, counts.waiting, counts.clusters, counts.effective_clusters, rate);
    line += text;
    if (settling_ > 0) {
        line += ", " + std::to_string(counts.solves_settle - settled_before_) + " of " +
                std::to_string(settling_) + " models settled";
    }
    if (expected_ > done_ && rate > 0.0)
        line += ", " + format_duration(static_cast<double>(expected_ - done_) / rate) + " left";
    std::cerr << "\r\x1b[K" << line << std::flush;
    line_open_ = true;
}

}  // namespace psfm
