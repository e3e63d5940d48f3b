// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/report/event_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "storage/exchange/files/json_text.h"

namespace psfm {
namespace {

using nlohmann::ordered_json;

/// Tenths of milliseconds are enough, and keep the log short.
double rounded(double milliseconds) {
    return std::round(milliseconds * 10.0) / 10.0;
}

double rounded_seconds(double seconds) {
    return rounded(seconds * 1000.0) / 1000.0;
}

/// Guard: lines that wait for space on the disk beside those of one message, at most [bytes]: of
/// some 50,000 images. Ours.
constexpr std::size_t kMostUnwritten = std::size_t{16} << 20U;

/// Left by a process that was killed while it wrote: what is appended begins a line of its own.
bool ends_within_a_line(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return false;
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream || stream.tellg() <= 0) return false;
    stream.seekg(-1, std::ios::end);
    return stream.get() != '\n';
}

}  // namespace

const char* name_of(SessionEvent::Kind kind) {
    switch (kind) {
        case SessionEvent::Kind::kRejected:
            return "rejected";
        case SessionEvent::Kind::kJoin:
            return "join";
        case SessionEvent::Kind::kSplit:
            return "split";
        case SessionEvent::Kind::kReset:
            return "reset";
        case SessionEvent::Kind::kTransfer:
            return "transfer";
        case SessionEvent::Kind::kAdopt:
            return "adopt";
        case SessionEvent::Kind::kPlaces:
            return "places";
        case SessionEvent::Kind::kCameras:
            return "cameras";
        case SessionEvent::Kind::kSettle:
            return "settle";
        case SessionEvent::Kind::kSolve:
            return "solve";
        case SessionEvent::Kind::kRemark:
            return "remark";
    }
    return "unknown";
}

std::string log_line(const ImageReport& image, const SessionCounts& counts) {
    ordered_json object{{"event", "image"},
                        {"index", image.index},
                        {"name", image.name},
                        {"clusters", counts.clusters},
                        {"effective_clusters", counts.effective_clusters},
                        {"placed", counts.placed},
                        {"waiting", counts.waiting},
                        {"resets", counts.resets},
                        {"latency_ms", rounded(image.latency_ms)}};
    object["stages_ms"] = ordered_json{
        {"extract", rounded(image.extract_ms)}, {"retrieve", rounded(image.retrieve_ms)},
        {"verify", rounded(image.verify_ms)},   {"cluster", rounded(image.cluster_ms)},
        {"solve", rounded(image.solve_ms)},     {"merge", rounded(image.merge_ms)}};
    object["version"] = counts.version;
    object["images"] = counts.images;
    object["rejected"] = counts.rejected;
    return json_text(object);
}

std::string log_line(const SessionEvent& event) {
    ordered_json object{{"event", name_of(event.kind)}, {"text", event.text}};
    if (!event.images.empty()) object["images"] = event.images;
    if (!event.clusters.empty()) object["clusters"] = event.clusters;
    if (!event.detail_json.empty()) {
        const ordered_json detail = parse_ordered_json(event.detail_json);
        if (detail.is_object()) object.update(detail);
    }
    return json_text(object);
}

std::string log_line(const GraphUsage& usage) {
    ordered_json nodes = ordered_json::array();
    for (const NodeUsage& node : usage.nodes) {
        nodes.push_back(ordered_json{{"node", name_of(node.node)},
                                     {"runs", node.runs},
                                     {"busy_s", rounded_seconds(node.busy_s)},
                                     {"waiting_s", rounded_seconds(node.waiting_s)},
                                     {"starved_s", rounded_seconds(node.starved_s)},
                                     {"work_s", rounded_seconds(node.work_s)},
                                     {"queued_s", rounded_seconds(node.queued_s)}});
    }
    return json_text(ordered_json{{"event", "nodes"},
                                  {"seconds", rounded_seconds(usage.seconds)},
                                  {"threads", usage.threads},
                                  {"nodes", std::move(nodes)}});
}

Result<std::unique_ptr<EventLog>> EventLog::open(const std::filesystem::path& file) {
    constexpr mode_t kFromUmask = 0666;  // Format: mode of a file that the umask decides on
    const int descriptor =
        ::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, kFromUmask);
    if (descriptor < 0) {
        return Error{ErrorCode::kIo, "cannot write the log " + file.string() + ": " +
                                         std::system_category().message(errno) +
                                         "; choose another --log"};
    }
    std::unique_ptr<EventLog> log(new EventLog(file, descriptor));
    if (ends_within_a_line(file)) log->append("\n");
    return log;
}

EventLog::~EventLog() {
    ::close(descriptor_);
}

void EventLog::write(const PublishMessage& publish) {
    std::string lines;
    for (const SessionEvent& event : publish.events) lines += log_line(event) + '\n';
    for (const ImageReport& image : publish.images) lines += log_line(image, publish.counts) + '\n';
    append(lines);
}

void EventLog::write(const GraphUsage& usage) {
    append(log_line(usage) + '\n');
}

void EventLog::append(const std::string& lines) {
    flush();
    if (unwritten_.empty() || unwritten_.size() + lines.size() <= kMostUnwritten) {
        unwritten_ += lines;
    } else {
        lost_ = true;
    }
    flush();
}

void EventLog::flush() {
    std::size_t written = 0;
    while (written < unwritten_.size()) {
        const ssize_t count =
            ::write(descriptor_, unwritten_.data() + written, unwritten_.size() - written);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) break;
        written += static_cast<std::size_t>(count);
    }
    unwritten_.erase(0, written);
}

}  // namespace psfm
