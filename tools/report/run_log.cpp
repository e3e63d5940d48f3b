// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/run_log.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "storage/exchange/files/json_text.h"

namespace psfm {
namespace {

using nlohmann::json;

double number(const json& object, const char* name) {
    const auto found = object.find(name);
    return found != object.end() && found->is_number() ? found->get<double>() : 0.0;
}

void add_nodes(const json& line, RunTimes& times) {
    times.seconds += number(line, "seconds");
    times.threads = static_cast<int>(number(line, "threads"));
    times.nodes.clear();
    for (const json& node : line.value("nodes", json::array())) {
        if (!node.is_object()) continue;
        times.nodes.push_back(
            {node.value("node", std::string()), static_cast<std::uint64_t>(number(node, "runs")),
             number(node, "busy_s"), number(node, "waiting_s"), number(node, "work_s")});
    }
}

}  // namespace

Result<RunTimes> read_run_log(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream) {
        return Error{ErrorCode::kNotFound,
                     file.string() + " cannot be read; --log wants what `psfm run --log` wrote"};
    }
    RunTimes times;
    std::vector<double> latencies;
    std::string text;
    while (std::getline(stream, text)) {
        const json line = parse_json(text);
        if (!line.is_object()) continue;
        const auto event = line.find("event");
        if (event == line.end() || !event->is_string()) continue;
        if (*event == "nodes") {
            add_nodes(line, times);
        } else if (*event == "image") {
            latencies.push_back(number(line, "latency_ms"));
            const auto stages = line.find("stages_ms");
            if (stages == line.end() || !stages->is_object()) continue;
            for (const auto& [stage, milliseconds] : stages->items()) {
                if (milliseconds.is_number())
                    times.stage_seconds[stage] += milliseconds.get<double>() / 1000.0;
            }
        }
    }
    times.images = latencies.size();
    if (!latencies.empty()) {
        std::ranges::sort(latencies);
        times.median_latency_ms = latencies[latencies.size() / 2];
        times.p95_latency_ms = latencies[latencies.size() * 95 / 100];
    }
    return times;
}

Machine this_machine() {
    Machine machine;
    machine.cores = std::thread::hardware_concurrency();
    machine.memory_gib = static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                         static_cast<double>(sysconf(_SC_PAGE_SIZE)) / (1024.0 * 1024.0 * 1024.0);
    std::ifstream cpuinfo("/proc/cpuinfo");
    std::string line;
    while (std::getline(cpuinfo, line)) {
        if (!line.starts_with("model name")) continue;
        const std::size_t colon = line.find(": ");
        if (colon != std::string::npos) machine.processor = line.substr(colon + 2);
        break;
    }
    return machine;
}

}  // namespace psfm
