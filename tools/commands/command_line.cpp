// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/command_line.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <iostream>
#include <utility>
#include <vector>

#include "tools/commands/commands.h"
#include "tools/commands/console/exit_codes.h"
#include "tools/commands/console/option_checks.h"

namespace psfm {
namespace {

/// "help COMMAND" is "COMMAND --help".
std::vector<std::string> words_of(int argc, char** argv) {
    std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (words.empty() || words.front() != "help") return words;
    words.erase(words.begin());
    words.emplace_back("--help");
    return words;
}

}  // namespace

int run_command_line(int argc, char** argv, const std::string& version) {
    CLI::App app{
        "psfm: progressive Structure from Motion. Photographs in, camera poses and a sparse model "
        "out, while "
        "they arrive."};
    app.footer(
        "First steps:\n"
        "  psfm run PHOTOS --session DIR\n"
        "  psfm status --session DIR\n"
        "  psfm export --session DIR --format colmap --output MODEL\n"
        "psfm help COMMAND tells what a command does, and its options.\n"
        "Exit codes: 0 done, 2 usage, 3 bad input, 4 session damaged, 1 anything else.");
    app.set_version_flag("--version", version);
    app.require_subcommand(1);
    int exit_code = 0;
    add_run_command(app, exit_code);
    add_resume_command(app, exit_code);
    add_import_command(app, exit_code);
    add_status_command(app, exit_code);
    add_report_command(app, exit_code);
    add_view_command(app, exit_code);
    add_serve_command(app, exit_code);
    add_decode_photograph_command(app, exit_code);
    add_export_command(app, exit_code);
    add_localise_command(app, exit_code);
    add_evaluate_command(app, exit_code);
    add_check_command(app, exit_code);
    add_repair_command(app, exit_code);
    add_remove_command(app, exit_code);
    add_compact_command(app, exit_code);
    add_options_command(app, exit_code);
    add_vocabulary_command(app, exit_code);
    add_simulate_command(app, exit_code);
    add_doctor_command(app, exit_code);
    refuse_empty_values(app);
    std::vector<std::string> words = words_of(argc, argv);
    const auto is_asked = [&](const CLI::App* command) {
        return command->check_name(words.front());
    };
    if (!words.empty() && !words.front().starts_with('-') &&
        app.get_subcommands(is_asked).empty()) {
        std::cerr << "psfm: there is no command '" << words.front()
                  << "'; psfm --help lists them\n";
        return kUsageError;
    }
    try {
        app.name(argv[0]);
        std::reverse(words.begin(), words.end());  // as CLI11 takes them
        app.parse(std::move(words));
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : kUsageError;
    }
    return exit_code;
}

}  // namespace psfm
