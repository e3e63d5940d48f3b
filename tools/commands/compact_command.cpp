// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>

#include "storage/session/session_store.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/report_error.h"

namespace psfm {
namespace {

std::uintmax_t bytes_in(const std::filesystem::path& folder) {
    std::uintmax_t bytes = 0;
    std::error_code ignored;
    for (std::filesystem::recursive_directory_iterator entry(folder, ignored), end;
         !ignored && entry != end; entry.increment(ignored)) {
        std::error_code gone;
        const auto size = entry->is_regular_file(gone) ? entry->file_size(gone) : 0;
        if (!gone) bytes += size;
    }
    return bytes;
}

int compact(const std::string& session) {
    const std::uintmax_t before = bytes_in(session);
    {
        auto store = SessionStore::open_existing(session, StoreOptions{});
        if (!store.ok()) return report_error(store.error());
        if (const auto done = (*store)->compact(); !done.ok()) return report_error(done.error());
    }
    std::cout << session << ": " << before << " bytes before, " << bytes_in(session) << " after\n";
    return 0;
}

}  // namespace

void add_compact_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "compact", "Give space back that replaced and dropped records of a session still take");
    auto session = std::make_shared<std::string>();
    command->add_option("--session", *session, "Session folder")->required();
    command->footer(
        "Needs as much free space as the session takes, for a moment.\nExample: psfm compact "
        "--session castle");
    command->callback([session, &exit_code] { exit_code = compact(*session); });
}

}  // namespace psfm
