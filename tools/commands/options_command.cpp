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
#include "tools/commands/console/report_error.h"

namespace psfm {
namespace {

struct OptionsArguments {
    std::string session;
    std::string preset = "default";
    bool markdown = false;
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

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", value);
    return text;
}

/// docs/options.md: a table a stage, with what the paper's preset has beside the defaults.
void print_markdown(const StageOptions& defaults, const StageOptions& paper) {
    std::cout << "# Options\n\nMade by `psfm options --markdown` from the program's own table. "
                 "`--set NAME=VALUE` sets "
                 "one for a new session, which\nkeeps all of them; `psfm options --session DIR` "
                 "shows them. *Paper* is "
                 "what `--preset paper` has where that differs\n(`scheduler/presets/paper.txt` "
                 "names the sections). "
                 "Beside each is where its default comes from: the paper, another\nprogram's name "
                 "of it, what it was "
                 "tuned on or where its figures are, or that it was not tuned. What raising "
                 "and\nlowering does stands in "
                 "the header of its struct.\n\n"
                 "Not in the table: `psfm localise`, `psfm evaluate` and features that an import "
                 "finds in photographs have no other\n"
                 "values than those in their structs (`LocaliseOptions`, `LocalisationMapOptions`, "
                 "`EvaluationOptions`,\n"
                 "`AdoptFeaturesOptions`); pictures of a `dataset` go by the flags of its export "
                 "(`PictureOptions`), the number of\n"
                 "words of `psfm vocabulary train` by its `--words` (`TrainOptions`).\n";
    std::string_view stage;
    for (const NamedOption& option : option_table()) {
        if (const auto of = option.name.substr(0, option.name.find('.')); of != stage) {
            stage = of;
            std::cout << "\n## " << stage
                      << "\n\n| name | default | paper | range | what | source |\n"
                      << "|---|---|---|---|---|---|\n";
        }
        const double value = option.get(defaults);
        const double in_paper = option.get(paper);
        std::cout << "| `" << option.name << "` | " << number(value) << " | "
                  << (in_paper == value ? "" : number(in_paper)) << " | " << number(option.low)
                  << " to " << number(option.high) << " | " << option.what << " | " << option.source
                  << " |\n";
    }
}

int print_options(const OptionsArguments& arguments) {
    if (arguments.markdown) {
        SessionConfig as_published;
        as_published.preset = "paper";
        const auto paper = stage_options(as_published);
        if (!paper.ok()) return report_error(paper.error());
        print_markdown(StageOptions{}, *paper);
        return 0;
    }
    const auto config = config_of(arguments);
    if (!config.ok()) return report_error(config.error());
    const auto options = stage_options(*config);
    if (!options.ok()) return report_error(options.error());
    for (const NamedOption& option : option_table()) {
        char line[96];
        std::snprintf(line, sizeof line, "%-52s %10g  ", std::string(option.name).c_str(),
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
    command
        ->add_flag("--markdown", arguments->markdown,
                   "The page docs/options.md: defaults, the paper's, ranges, sources")
        ->excludes(session);
    command->footer(
        "A session keeps the values that it was begun with.\n"
        "Examples:\n"
        "  psfm options\n"
        "  psfm run photos --session castle --set features.sift.max_features=4096");
    command->callback([arguments, &exit_code] { exit_code = print_options(*arguments); });
}

}  // namespace psfm
