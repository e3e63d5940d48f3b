// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/run_state.h"

#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "storage/exchange/files/json_text.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kName = "running.json";

bool is_alive(std::int64_t pid) {
    return pid > 0 && (::kill(static_cast<pid_t>(pid), 0) == 0 || errno == EPERM);
}

double rounded(double value) {
    return std::round(value * 1000.0) / 1000.0;
}

}  // namespace

void write_run_state(const fs::path& session, const RunState& state) {
    ordered_json object{{"pid", state.pid},
                        {"seconds", rounded(state.seconds)},
                        {"done", state.done},
                        {"expected", state.expected},
                        {"images_per_second", rounded(state.images_per_second)},
                        {"settling", state.settling}};
    if (state.seconds_left) object["seconds_left"] = rounded(*state.seconds_left);
    const fs::path part = session / (std::string(kName) + ".part");
    {
        std::ofstream file(part, std::ios::trunc);
        file << json_text(object) << '\n';
        if (!file.flush()) return;
    }
    std::error_code ignored;
    fs::rename(part, session / kName, ignored);
}

void remove_run_state(const fs::path& session) {
    std::error_code ignored;
    fs::remove(session / kName, ignored);
}

std::optional<RunState> read_run_state(const fs::path& session) {
    std::ifstream file(session / kName);
    if (!file) return std::nullopt;
    const std::string text(std::istreambuf_iterator<char>(file), {});
    const auto object = parse_json(text);
    if (!object.is_object()) return std::nullopt;
    try {
        RunState state;
        state.pid = object.at("pid").get<std::int64_t>();
        state.seconds = object.at("seconds").get<double>();
        state.done = object.at("done").get<std::uint64_t>();
        state.expected = object.at("expected").get<std::uint64_t>();
        state.images_per_second = object.at("images_per_second").get<double>();
        state.settling = object.at("settling").get<bool>();
        if (object.contains("seconds_left"))
            state.seconds_left = object.at("seconds_left").get<double>();
        return is_alive(state.pid) ? std::optional(state) : std::nullopt;
    } catch (const nlohmann::json::exception&) {
        return std::nullopt;
    }
}

}  // namespace psfm
