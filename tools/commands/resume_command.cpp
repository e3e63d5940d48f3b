// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>

#include "tools/commands/commands.h"
#include "tools/commands/report_error.h"
#include "tools/commands/session_options.h"
#include "tools/commands/session_runner.h"

namespace psfm {
namespace {

struct ResumeArguments {
    std::string session;
    std::string log;
    int threads = 0;
    std::size_t cache_mib = StoreOptions{}.cache_bytes >> 20U;
};

int resume(const ResumeArguments& arguments) {
    StoreOptions store_options;
    store_options.cache_bytes = arguments.cache_mib << 20U;
    auto store = SessionStore::open_existing(arguments.session, store_options);
    if (!store.ok()) return report_error(store.error());
    const auto settings = (*store)->settings();
    if (!settings.ok()) return report_error(settings.error());
    auto config = decode_config(settings->settings_json);
    if (!config.ok()) return report_error(config.error());
    RunRequest request;
    request.session = arguments.session;
    request.input = settings->photo_folder;
    request.config = *std::move(config);
    request.execution.threads = arguments.threads;
    request.execution.idle_bytes = idle_bytes(store_options);
    request.log_file = arguments.log;
    return run_and_report(**store, request);
}

}  // namespace

void add_resume_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "resume", "Go on with a session that was stopped, killed or lost its power");
    auto arguments = std::make_shared<ResumeArguments>();
    command->add_option("--session", arguments->session, "Session folder")->required();
    command->add_option("--threads", arguments->threads, "Threads to use; 0: one a core")
        ->check(CLI::Range(0, 1024));
    add_cache_option(*command, arguments->cache_mib);
    command->add_option("--log", arguments->log, "Append a log of JSON lines to this file");
    command->footer(
        "The session remembers its photograph folder, order and options. What was acknowledged is "
        "not\n"
        "computed again; what was in flight is.\nExample: psfm resume --session castle");
    command->callback([arguments, &exit_code] { exit_code = resume(*arguments); });
}

}  // namespace psfm
