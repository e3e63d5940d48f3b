// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "scheduler/session/option_table.h"
#include "storage/session/session_store.h"
#include "tools/commands/commands.h"
#include "tools/commands/report_error.h"

namespace psfm {
namespace {

struct OptionsArguments {
    std::string session;
    std::string preset = "default";
};

Result<SessionConfig> config_of(const OptionsArguments& arguments) {
    SessionConfig config;
    config.preset = arguments.preset;
    if (arguments.session.empty()) return config;
    const auto reader = open_session_reader(arguments.session, StoreOptions{});
    if (!reader.ok()) return reader.error();
    const auto settings = (*reader)->settings();
    if (!settings.ok()) return settings.error();
    return decode_config(settings->settings_json);
}

int print_options(const OptionsArguments& arguments) {
    const auto config = config_of(arguments);
    if (!config.ok()) return report_error(config.error());
    const auto options = stage_options(*config);
    if (!options.ok()) return report_error(options.error());
    for (const NamedOption& option : option_table()) {
        char line[96];
        std::snprintf(line, sizeof line, "%-44s %10g  ", std::string(option.name).c_str(),
                      option.get(*options));
        std::cout << line << option.what << '\n';
    }
    return 0;
}

}  // namespace

void add_options_command(CLI::App& app, int& exit_code) {
    CLI::App* command =
        app.add_subcommand("options", "List the options that --set sets, with their values");
    auto arguments = std::make_shared<OptionsArguments>();
    auto* session = command->add_option("--session", arguments->session,
                                        "Those of a session; default: those of a new one");
    command->add_option("--preset", arguments->preset, "Those of a new session with this preset")
        ->check(CLI::IsMember({"default", "paper"}))
        ->excludes(session);
    command->footer(
        "A session keeps the values that it was begun with.\n"
        "Examples:\n"
        "  psfm options\n"
        "  psfm run photos --session castle --set features.sift.max_features=4096");
    command->callback([arguments, &exit_code] { exit_code = print_options(*arguments); });
}

}  // namespace psfm
