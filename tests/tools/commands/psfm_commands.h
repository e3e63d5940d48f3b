// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "tools/commands/commands.h"

namespace psfm::test {

/// `psfm ARGUMENTS` within the test's own process: run, export and report. @return its exit code
inline int psfm_command(std::vector<std::string> arguments) {
    CLI::App app{"psfm"};
    app.require_subcommand(1);
    int exit_code = 0;
    add_run_command(app, exit_code);
    add_export_command(app, exit_code);
    add_report_command(app, exit_code);
    std::ranges::reverse(arguments);
    try {
        app.parse(arguments);
    } catch (const CLI::ParseError& error) {
        exit_code = app.exit(error) == 0 ? 0 : 2;
    }
    return exit_code;
}

}  // namespace psfm::test
