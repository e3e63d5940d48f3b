// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <iostream>
#include <memory>

#include "scheduler/session/file_stamp.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/session/photo_order.h"
#include "tools/commands/session/session_options.h"
#include "tools/commands/session/session_runner.h"

namespace psfm {
namespace {

struct ResumeArguments {
    std::string session;
    std::string log;
    int threads = 0;
    std::size_t cache_mib = StoreOptions{}.cache_bytes >> 20U;
    std::uint32_t memory_mib = SessionConfig{}.memory_mib;
    bool is_memory_given = false;
};

/// What is there of the photographs that the session began with. Those that it has need not be:
/// without the others it goes on, too.
Result<FoundPhotos> photos_left(const SessionReader& store, const RunRequest& request) {
    auto known = known_names(store);
    if (!known.ok()) return known.error();
    auto photos = photos_by_name(request);
    if (!photos.ok()) {
        if (known->empty() || !request.config.colmap_database.empty()) return photos;
        std::cerr << "psfm: " << photos.error().message << "; going on with what the session has\n";
        return FoundPhotos();
    }
    std::size_t gone = 0;
    for (const std::string& name : request.config.order) {
        const bool is_there =
            std::ranges::binary_search(photos->photos, name, {}, &PhotoFile::name);
        if (is_there || !known->insert(name).second) continue;
        if (!is_gone(request.input / name)) continue;  // rejected, and told of, by who listed them
        if (gone++ == 0) std::cerr << "psfm: " << request.input.string() << " lacks " << name;
    }
    if (gone > 1) std::cerr << " and " << gone - 1 << " more";
    if (gone > 0) std::cerr << " of the session's order; going on without\n";
    auto ordered =
        photos_in_order(std::move(photos->photos), request.config.order, *known, request.input);
    if (!ordered.ok()) return ordered.error();
    (*photos).photos = *std::move(ordered);
    return photos;
}

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
    request.input = input_of(*settings, *config);
    request.config = *std::move(config);
    if (arguments.is_memory_given && request.config.memory_mib != arguments.memory_mib) {
        request.config.memory_mib = arguments.memory_mib;
        request.settings = SessionSettings{settings->photo_folder, encode_config(request.config)};
    }
    request.go_on_command = command_line("resume", request.session);
    auto photos = photos_left(**store, request);
    if (!photos.ok()) return report_error(photos.error(), ErrorOrigin::kOtherInput);
    request.photos = std::move(photos->photos);
    request.unread = std::move(photos->unread);
    if (const auto done = compare_photos(request, **store, false); !done.ok())
        return report_error(done.error(), ErrorOrigin::kOtherInput);
    request.execution = execution_of(arguments.threads, store_options);
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
    add_memory_option(*command, arguments->memory_mib);
    command->add_option("--log", arguments->log, "Append a log of JSON lines to this file");
    command->footer(
        "The session remembers its photograph folder, order and options. What was acknowledged is "
        "not\n"
        "computed again; what was in flight is.\nExample: psfm resume --session castle");
    command->callback([command, arguments, &exit_code] {
        arguments->is_memory_given = command->get_option("--memory")->count() > 0;
        exit_code = resume(*arguments);
    });
}

}  // namespace psfm
