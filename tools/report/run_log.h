// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "graph/result.h"

namespace psfm {

/// What a log of `psfm run --log` says of times.
struct RunTimes {
    struct Node {
        std::string name;
        std::uint64_t runs = 0;
        double busy_s = 0.0, waiting_s = 0.0, work_s = 0.0;
    };
    std::size_t images = 0;
    double median_latency_ms = 0.0, p95_latency_ms = 0.0;
    std::map<std::string, double> stage_seconds;  ///< summed over images, by stage
    double seconds = 0.0;                         ///< of all runs in the log, those that ended
    int threads = 0;                              ///< of the last one
    std::vector<Node> nodes;                      ///< of the last one
};

/// Lines that are no JSON are passed over (a log ends in the middle of one when psfm was killed).
/// @errors kNotFound, kIo
Result<RunTimes> read_run_log(const std::filesystem::path& file);

/// The machine that this process runs on: processor, cores, memory.
struct Machine {
    std::string processor;
    unsigned cores = 0;
    double memory_gib = 0.0;
};
Machine this_machine();

}  // namespace psfm
