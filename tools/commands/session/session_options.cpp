// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/session/session_options.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <set>
#include <utility>

#include "scheduler/session/option_table.h"
#include "stages/retrieval/vocabulary_file.h"
#include "tools/commands/console/option_checks.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/shell_word.h"
#include "tools/commands/session/photo_order.h"
#include "tools/commands/session/session_runner.h"

namespace psfm {
namespace {

bool is_given(const CLI::App& command, const std::string& option) {
    const CLI::Option* known = command.get_option_no_throw(option);
    return known != nullptr && known->count() > 0;
}

/// What a session was begun with holds for all of its life; only the photographs and their order,
/// given cameras, what is kept of versions and how it is executed may change from run to run.
Result<SessionConfig> continue_config(const SessionConfig& begun, SessionConfig asked,
                                      const CLI::App& command) {
    const auto holds = [&](const char* option, auto setting) {
        const bool differs = is_given(command, option) && asked.*setting != begun.*setting;
        asked.*setting = begun.*setting;
        return !differs;
    };
    const auto differs = [](const std::string& option) -> Error {
        return {ErrorCode::kInvalidArgument, "the session was begun with another " + option +
                                                 "; leave the option out, or begin a new session"};
    };
    if (!holds("--preset", &SessionConfig::preset)) return differs("--preset");
    if (!holds("--camera-sharing", &SessionConfig::camera_sharing))
        return differs("--camera-sharing");
    if (!holds("--fix-intrinsics", &SessionConfig::fix_intrinsics))
        return differs("--fix-intrinsics");
    if (!holds("--seed", &SessionConfig::seed)) return differs("--seed");
    if (!holds("--vocabulary", &SessionConfig::vocabulary_file)) return differs("--vocabulary");
    const auto of_session = stage_options(begun);
    if (!of_session.ok()) return of_session.error();
    for (const auto& setting : asked.options) {
        StageOptions options = *of_session;
        if (const auto set = set_options(options, {setting}); !set.ok()) return set.error();
        if (option_values(options) != option_values(*of_session))
            return differs("--set " + setting.first);
    }
    asked.options = begun.options;
    if (!is_given(command, "--history")) asked.history = begun.history;
    if (!is_given(command, "--memory")) asked.memory_mib = begun.memory_mib;
    if (!is_given(command, "--masks")) asked.masks = begun.masks;
    if (!is_given(command, "--images")) asked.database_photos = begun.database_photos;
    if (begun.colmap_database != asked.colmap_database) {
        return Error{ErrorCode::kInvalidArgument,
                     begun.colmap_database.empty()
                         ? std::string("the session was begun with photographs (`psfm run`); "
                                       "import into a new one")
                         : "the session was begun from " + begun.colmap_database +
                               "; continue it with `psfm import` and that file"};
    }
    asked.image_ids = begun.image_ids;
    asked.camera_ids = begun.camera_ids;
    asked.repeated_observations = begun.repeated_observations;
    asked.anchors = begun.anchors;
    asked.keep_world = begun.keep_world;
    for (const auto& [name, given] : begun.given_cameras)
        asked.given_cameras.try_emplace(name, given);
    return asked;
}

/// As the session was begun, if it was: one without an image may become anything yet.
Result<SessionConfig> settle_config(const SessionStore& store, SessionConfig asked,
                                    const CLI::App& command) {
    const auto settings = store.settings();
    if (!settings.ok() && settings.error().code == ErrorCode::kNotFound) return asked;
    if (!settings.ok()) return settings.error();
    const auto begun = decode_config(settings->settings_json);
    if (!begun.ok()) return begun.error();
    const auto images = store.images();
    if (!images.ok()) return images.error();
    if (images->empty()) return asked;
    return continue_config(*begun, std::move(asked), command);
}

}  // namespace

void add_cache_option(CLI::App& command, std::size_t& mib) {
    command
        .add_option("--cache", mib,
                    "Memory for features and records that are used again, and for those that are "
                    "on their way to the disk [MiB]; an eighth as much beside it for keypoints "
                    "of clusters that rest, and an eighth for their points")
        ->check(CLI::Range(64, 1 << 20))
        ->capture_default_str();
}

void add_memory_option(CLI::App& command, std::uint32_t& mib) {
    command
        .add_option("--memory", mib,
                    "Memory beside the cache for photographs that are being read [MiB]: as many "
                    "at once as it lasts for; the session keeps it")
        ->check(CLI::Range(64, 1 << 22))
        ->capture_default_str();
}

void add_session_options(CLI::App& command, SessionArguments& arguments) {
    command
        .add_option("--session", arguments.session,
                    "Session folder: made when it does not exist, continued when it does")
        ->required();
    auto* order = command.add_option("--order", arguments.order_file,
                                     "File with one image name a line: that order, and only those");
    command
        .add_option("--shuffle", arguments.shuffle,
                    "Random order: names sorted, then shuffled with this seed")
        ->check(whole_number_problem)
        ->excludes(order);
    command.add_flag("--batch", arguments.batch, "Solve only after the last image has arrived");
    command.add_flag("--deterministic", arguments.deterministic,
                     "Take every image through the whole graph before the next: same result on "
                     "any number of threads");
    command.add_option("--threads", arguments.threads, "Threads to use; 0: one a core")
        ->check(CLI::Range(0, 1024));
    add_cache_option(command, arguments.cache_mib);
    add_memory_option(command, arguments.memory_mib);
    command.add_flag("--fix-intrinsics", arguments.fix_intrinsics, "Never refine intrinsics");
    command
        .add_option("--preset", arguments.preset,
                    "default, or paper: the methods and parameters as published")
        ->check(CLI::IsMember({"default", "paper"}));
    command
        .add_option("--history", arguments.history,
                    "What is kept of every version: none, poses, full (points, too)")
        ->check(CLI::IsMember({"none", "poses", "full"}));
    command.add_option("--log", arguments.log, "Append a log of JSON lines to this file");
    command.add_option("--seed", arguments.seed, "Seed of everything random")
        ->check(whole_number_problem);
    command
        .add_option(
            "--set", arguments.settings,
            "Set an option of the stages, NAME=VALUE; may be repeated. `psfm options` lists "
            "names, values and what they do")
        ->take_all();
}

Result<SessionConfig> config_from(const SessionArguments& arguments,
                                  const std::function<Result<std::vector<std::string>>()>& names) {
    SessionConfig config;
    config.preset = arguments.preset;
    config.fix_intrinsics = arguments.fix_intrinsics;
    config.deterministic = arguments.deterministic;
    config.batch = arguments.batch;
    config.seed = arguments.seed;
    config.history = *history_from_name(arguments.history);
    for (const std::string& text : arguments.settings) {
        auto setting = parse_setting(text);
        if (!setting.ok()) return setting.error();
        config.options.insert_or_assign(setting->first, setting->second);
    }
    if (const auto valid = stage_options(config); !valid.ok()) return valid.error();
    config.memory_mib = arguments.memory_mib;
    if (!arguments.order_file.empty()) {
        auto order = read_order_file(arguments.order_file);
        if (!order.ok()) return order.error();
        config.order = *std::move(order);
    } else if (arguments.shuffle) {
        auto all = names();
        if (!all.ok()) return all.error();
        config.order = shuffled_names(*std::move(all), *arguments.shuffle);
    }
    return config;
}

namespace {

/// What a new session is to use can be used. A log may lie in the session's own folder.
Result<void> check_named_files(const RunRequest& request) {
    const std::string& vocabulary = request.config.vocabulary_file;
    if (!vocabulary.empty()) {
        if (const auto words = read_vocabulary(vocabulary); !words.ok()) return words.error();
    }
    if (request.log_file.empty()) return {};
    const auto as_folder = [](const std::filesystem::path& path) {
        return (std::filesystem::absolute(path) / "").lexically_normal();
    };
    const std::filesystem::path folder =
        as_folder(std::filesystem::absolute(request.log_file).parent_path());
    if (folder == as_folder(request.session)) return {};
    std::error_code unknown;
    if (std::filesystem::is_directory(folder, unknown)) return {};
    return Error{ErrorCode::kIo, "cannot write the log " + request.log_file +
                                     ": there is no folder " + folder.string() +
                                     "; make it, or choose another --log"};
}

bool holds_nothing(const std::filesystem::path& folder) {
    std::error_code unknown;  // then it is for the store to say
    return !std::filesystem::exists(folder, unknown) ||
           (std::filesystem::is_empty(folder, unknown) && !unknown);
}

}  // namespace

int start_session(const CLI::App& command, const SessionArguments& arguments,
                  const std::filesystem::path& input, SessionConfig config, bool watch) {
    RunRequest request;
    request.session = arguments.session;
    request.input = input;
    request.config = std::move(config);
    request.log_file = arguments.log;
    request.watch = watch;
    request.go_on_command = command_line("resume", request.session);
    if (watch) {
        request.go_on_command =
            command_line("run " + shell_word(input.string()), request.session) + " --watch";
    } else {
        auto photos = photos_by_name(request);
        if (!photos.ok()) return report_error(photos.error(), ErrorOrigin::kOtherInput);
        request.photos = std::move(photos->photos);
        request.unread = std::move(photos->unread);
    }
    const auto put_in_order = [&](const std::set<std::string>& known) -> Result<void> {
        auto ordered = photos_in_order(request.photos, request.config.order, known, input);
        if (!ordered.ok()) return ordered.error();
        request.photos = *std::move(ordered);
        return {};
    };
    // Before a session is made: a mistyped name leaves nothing behind.
    if (holds_nothing(request.session)) {
        if (const auto found = check_named_files(request); !found.ok())
            return report_error(found.error(), ErrorOrigin::kOtherInput);
        if (const auto done = watch ? Result<void>{} : put_in_order({}); !done.ok())
            return report_error(done.error(), ErrorOrigin::kOtherInput);
    }

    StoreOptions store_options;
    store_options.cache_bytes = arguments.cache_mib << 20U;
    request.execution = execution_of(arguments.threads, store_options);
    auto store = SessionStore::open(arguments.session, store_options);
    if (!store.ok()) return report_error(store.error());
    auto settled = settle_config(**store, std::move(request.config), command);
    if (!settled.ok()) {
        const bool is_asked = settled.error().code == ErrorCode::kInvalidArgument;
        return report_error(settled.error(),
                            is_asked ? ErrorOrigin::kOtherInput : ErrorOrigin::kSession);
    }
    request.config = *std::move(settled);
    if (!watch) {
        const auto known = known_names(**store);
        if (!known.ok()) return report_error(known.error());
        if (const auto done = put_in_order(*known); !done.ok())
            return report_error(done.error(), ErrorOrigin::kOtherInput);
    }
    if (const auto done = compare_photos(request, **store, is_given(command, "--masks"));
        !done.ok())
        return report_error(done.error(), ErrorOrigin::kOtherInput);
    // All of them, so that the session goes on as it began.
    request.config.options = option_values(*stage_options(request.config));
    std::filesystem::path photos = input;
    if (!request.config.database_photos.empty()) photos = request.config.database_photos;
    request.settings =
        SessionSettings{std::filesystem::absolute(photos).lexically_normal().string(),
                        encode_config(request.config)};
    return run_and_report(**store, request);
}

}  // namespace psfm
