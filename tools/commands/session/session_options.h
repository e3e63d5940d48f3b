// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "graph/result.h"
#include "scheduler/session/session_config.h"
#include "storage/session/session_store.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's
class App;
}

namespace psfm {

/// The options that `run` and `import` share.
struct SessionArguments {
    std::string session;
    std::string order_file;
    std::optional<std::uint64_t> shuffle;
    std::string preset = "default";
    std::string log;
    std::string history = "poses";
    bool batch = false;
    bool deterministic = false;
    bool fix_intrinsics = false;
    int threads = 0;
    std::size_t cache_mib = StoreOptions{}.cache_bytes >> 20U;
    std::uint32_t memory_mib = SessionConfig{}.memory_mib;
    std::uint64_t seed = 0;
    std::vector<std::string> settings;  ///< NAME=VALUE
};

/// --cache, of what opens a session for writing. @param mib  outlives the parsing
void add_cache_option(CLI::App& command, std::size_t& mib);
/// --memory, of what reads photographs. @param mib  outlives the parsing
void add_memory_option(CLI::App& command, std::uint32_t& mib);
/// @param arguments  filled when the command line is parsed; outlives that
void add_session_options(CLI::App& command, SessionArguments& arguments);

/// The part of a configuration that these options set.
/// @param names  of all images, in any order; asked for when they are to be shuffled
/// @errors of the order file and of `names`
Result<SessionConfig> config_from(const SessionArguments& arguments,
                                  const std::function<Result<std::vector<std::string>>()>& names);

/// Opens the session or makes it, and runs it. One that has images goes on as it was begun: of what
/// shapes results, what the command line leaves out is as it was, and what it asks for has to be.
/// Nothing of a session is changed, and none is made, by a command that cannot be followed.
/// @param command  parsed: which options were given
/// @param input  folder of photographs, or the database
/// @return the program's exit code; failures have been reported
int start_session(const CLI::App& command, const SessionArguments& arguments,
                  const std::filesystem::path& input, SessionConfig config, bool watch);

}  // namespace psfm
