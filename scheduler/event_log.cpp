// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/event_log.h"

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

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

std::string dump(const ordered_json& object) {
    return object.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

/// Left by a process that was killed while it wrote: what is appended begins a line of its own.
bool ends_within_a_line(const std::filesystem::path& file) {
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
        case SessionEvent::Kind::kSettle:
            return "settle";
        case SessionEvent::Kind::kSolve:
            return "solve";
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
    return dump(object);
}

std::string log_line(const SessionEvent& event) {
    ordered_json object{{"event", name_of(event.kind)}, {"text", event.text}};
    if (!event.images.empty()) object["images"] = event.images;
    if (!event.clusters.empty()) object["clusters"] = event.clusters;
    if (!event.detail_json.empty()) {
        const ordered_json detail = ordered_json::parse(event.detail_json, nullptr, false);
        if (detail.is_object()) object.update(detail);
    }
    return dump(object);
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
    return dump(ordered_json{{"event", "nodes"},
                             {"seconds", rounded_seconds(usage.seconds)},
                             {"threads", usage.threads},
                             {"nodes", std::move(nodes)}});
}

Result<std::unique_ptr<EventLog>> EventLog::open(const std::filesystem::path& file) {
    const bool torn = ends_within_a_line(file);
    std::ofstream stream(file, std::ios::app);
    if (torn) stream << '\n';
    if (!stream) {
        return Error{ErrorCode::kIo, "cannot write the log " + file.string() + ": " +
                                         std::strerror(errno) + "; choose another --log"};
    }
    return std::unique_ptr<EventLog>(new EventLog(std::move(stream)));
}

void EventLog::write(const PublishMessage& publish) {
    for (const SessionEvent& event : publish.events) stream_ << log_line(event) << '\n';
    for (const ImageReport& image : publish.images)
        stream_ << log_line(image, publish.counts) << '\n';
    stream_.flush();
}

void EventLog::write(const GraphUsage& usage) {
    stream_ << log_line(usage) << '\n';
    stream_.flush();
}

}  // namespace psfm
