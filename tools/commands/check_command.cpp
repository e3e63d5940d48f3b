// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <iostream>
#include <memory>

#include "graph/wording.h"
#include "storage/session/session_store.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/exit_codes.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/shell_word.h"

namespace psfm {
namespace {

int check(const std::string& session) {
    auto reader = open_session_reader(session, StoreOptions{});
    if (!reader.ok()) return report_error(reader.error());
    const bool terminal = isatty(STDERR_FILENO) == 1;
    const auto report = (*reader)->check([&](std::uint64_t done) {
        if (terminal && done % 100 == 0) std::cerr << '\r' << done << " records" << std::flush;
    });
    if (terminal) std::cerr << "\r\x1b[K";
    if (!report.ok()) return report_error(report.error());
    for (const auto& [kind, count] : report->records) std::cout << kind << ": " << count << '\n';
    for (const DamagedRecord& damaged : report->damaged) {
        std::cout << "DAMAGED " << damaged.kind << ' ' << damaged.key << ": " << damaged.problem
                  << '\n';
    }
    if (report->damaged.empty()) {
        std::cout << "every record is intact\n";
        return 0;
    }
    std::cerr << "psfm: " << counted(report->damaged.size(), "damaged record") << " in " << session
              << "; recompute what can be with: psfm repair --session " << shell_word(session)
              << '\n';
    return kStoreDamaged;
}

}  // namespace

void add_check_command(CLI::App& app, int& exit_code) {
    CLI::App* command =
        app.add_subcommand("check", "Verify every record of a session; works beside a running one");
    auto session = std::make_shared<std::string>();
    command->add_option("--session", *session, "Session folder")->required();
    command->footer(
        "Exit code 0 when every record is intact, 4 when one is damaged.\nExample: psfm check "
        "--session castle");
    command->callback([session, &exit_code] { exit_code = check(*session); });
}

}  // namespace psfm
