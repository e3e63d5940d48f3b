// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace psfm {

/// What a process that works on a session says of itself, in SESSION/running.json: a note beside
/// the store, not part of it. Nothing is lost with it.
struct RunState {
    std::int64_t pid = 0;
    double seconds = 0.0;        ///< since it began
    std::uint64_t done = 0;      ///< photographs of this run that a version takes account of
    std::uint64_t expected = 0;  ///< of this run; 0: not known (a watched folder, uploads)
    double images_per_second = 0.0;
    bool settling = false;               ///< no photograph follows; models are adjusted to the end
    std::optional<double> seconds_left;  ///< settling included; nothing: not known
};

/// Written whole or not at all; failures are let go of: the run is worth more than the note.
void write_run_state(const std::filesystem::path& session, const RunState& state);
void remove_run_state(const std::filesystem::path& session);

/// Of the process that works on the session at present; nothing when there is none, whatever an
/// earlier one has left behind.
std::optional<RunState> read_run_state(const std::filesystem::path& session);

}  // namespace psfm
