// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/session_options.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <map>

#include "tools/commands/photo_order.h"
#include "tools/commands/report_error.h"
#include "tools/commands/session_runner.h"

namespace psfm {
namespace {

const std::map<std::string, History> kHistories{
    {"none", History::kNone}, {"poses", History::kPoses}, {"full", History::kFull}};

/// What a session was begun with holds for all of its life; only the photographs and their order,
/// given cameras and how it is executed may change from run to run.
Result<SessionConfig> continue_config(const SessionConfig& begun, SessionConfig asked) {
    const auto differs = [&](const std::string& option) -> Error {
        return {ErrorCode::kInvalidArgument,
                "the session was begun with another " + option +
                    "; leave the option as it was, or begin a new session"};
    };
    if (begun.preset != asked.preset) return differs("--preset");
    if (begun.camera_sharing != asked.camera_sharing) return differs("--camera-sharing");
    if (begun.fix_intrinsics != asked.fix_intrinsics) return differs("--fix-intrinsics");
    if (begun.seed != asked.seed) return differs("--seed");
    if (begun.colmap_database != asked.colmap_database) {
        return Error{ErrorCode::kInvalidArgument,
                     begun.colmap_database.empty()
                         ? std::string("the session was begun with photographs (`psfm run`); "
                                       "import into a new one")
                         : "the session was begun from " + begun.colmap_database +
                               "; continue it with `psfm import` and that file"};
    }
    if (begun.vocabulary_file != asked.vocabulary_file) return differs("--vocabulary");
    for (const auto& [name, given] : begun.given_cameras)
        asked.given_cameras.try_emplace(name, given);
    return asked;
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
        ->excludes(order);
    command.add_flag("--batch", arguments.batch, "Solve only after the last image has arrived");
    command.add_flag("--deterministic", arguments.deterministic,
                     "Take every image through the whole graph before the next: same result on "
                     "any number of threads");
    command.add_option("--threads", arguments.threads, "Threads to use; 0: one a core")
        ->check(CLI::Range(0, 1024));
    add_cache_option(command, arguments.cache_mib);
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
    command.add_option("--seed", arguments.seed, "Seed of everything random");
}

Result<SessionConfig> config_from(const SessionArguments& arguments,
                                  const std::function<Result<std::vector<std::string>>()>& names) {
    SessionConfig config;
    config.preset = arguments.preset;
    config.fix_intrinsics = arguments.fix_intrinsics;
    config.deterministic = arguments.deterministic;
    config.batch = arguments.batch;
    config.seed = arguments.seed;
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

int start_session(const SessionArguments& arguments, const std::filesystem::path& input,
                  SessionConfig config, bool watch) {
    StoreOptions store_options;
    store_options.cache_bytes = arguments.cache_mib << 20U;
    store_options.history = kHistories.at(arguments.history);
    auto store = SessionStore::open(arguments.session, store_options);
    if (!store.ok()) return report_error(store.error());
    const auto settings = (*store)->settings();
    const bool is_new = !settings.ok() && settings.error().code == ErrorCode::kNotFound;
    if (!settings.ok() && !is_new) return report_error(settings.error());
    if (!is_new) {
        const auto begun = decode_config(settings->settings_json);
        if (!begun.ok()) return report_error(begun.error());
        auto continued = continue_config(*begun, std::move(config));
        if (!continued.ok()) return report_error(continued.error(), ErrorOrigin::kOtherInput);
        config = *std::move(continued);
    }
    const SessionSettings stored{std::filesystem::absolute(input).lexically_normal().string(),
                                 encode_config(config)};
    if (const auto done = (*store)->put_settings(stored); !done.ok())
        return report_error(done.error());

    RunRequest request;
    request.session = arguments.session;
    request.input = input;
    request.config = std::move(config);
    request.execution.threads = arguments.threads;
    request.execution.idle_bytes = idle_bytes(store_options);
    request.log_file = arguments.log;
    request.watch = watch;
    return run_and_report(**store, request);
}

}  // namespace psfm
