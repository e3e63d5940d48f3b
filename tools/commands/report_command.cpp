// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <iostream>
#include <memory>

#include "storage/session/session_store.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/write_whole_file.h"
#include "tools/report/report_page.h"
#include "tools/report/scene_reference.h"
#include "tools/serve/uploads/sent_photographs.h"

namespace psfm {
namespace {

struct ReportArguments {
    std::string session;
    std::string output;
    std::string json;
    std::string log;
    bool share_location = false;
};

int report(const ReportArguments& arguments) {
    ReportOptions options;
    options.session = std::filesystem::absolute(arguments.session).lexically_normal().filename();
    options.share_location = arguments.share_location;
    options.machine = this_machine();
    if (!arguments.log.empty()) {
        auto times = read_run_log(arguments.log);
        if (!times.ok()) return report_error(times.error(), ErrorOrigin::kOtherInput);
        options.times = *std::move(times);
    }
    const auto session = open_session_reader(arguments.session, StoreOptions{});
    if (!session.ok()) return report_error(session.error());
    FactsMemory memory;
    auto facts = read_session_facts(**session, memory);
    if (!facts.ok()) return report_error(facts.error());
    add_origins(SentPhotographs(arguments.session), *facts);
    const auto reference = world_reference_of(facts->scene, facts->images);
    const auto all = read_report_facts(**session, reference, *std::move(facts));
    if (!all.ok()) return report_error(all.error());
    if (const auto written = write_whole_file(arguments.output, report_page(*all, options));
        !written.ok()) {
        return report_error(written.error(), ErrorOrigin::kOtherInput);
    }
    if (!arguments.json.empty()) {
        if (const auto written = write_whole_file(arguments.json, report_json(*all, options));
            !written.ok()) {
            return report_error(written.error(), ErrorOrigin::kOtherInput);
        }
    }
    std::cout << arguments.output << ": open it in a browser\n";
    return 0;
}

}  // namespace

void add_report_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "report", "One page about a session that needs no network and prints; works beside a run");
    auto arguments = std::make_shared<ReportArguments>();
    command->add_option("--session", arguments->session, "Session folder")->required();
    command->add_option("--output", arguments->output, "HTML file to write")->required();
    command->add_option("--json", arguments->json, "The same figures for programs, into this file");
    command->add_option("--log", arguments->log,
                        "The log of `psfm run --log`, for times and latencies");
    command->add_flag("--share-location", arguments->share_location,
                      "Say where on the earth the session stands; without it the report has no "
                      "position");
    command->footer("Example: psfm report --session castle --output castle.html");
    command->callback([arguments, &exit_code] { exit_code = report(*arguments); });
}

}  // namespace psfm
