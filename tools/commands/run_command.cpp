// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <optional>

#include "stages/features/assign_camera.h"
#include "stages/features/photo_listing.h"
#include "tools/commands/commands.h"
#include "tools/commands/given_cameras.h"
#include "tools/commands/photo_order.h"
#include "tools/commands/report_error.h"
#include "tools/commands/session_runner.h"

namespace psfm {
namespace {

struct RunArguments {
    std::string photos;
    std::string session;
    std::string order_file;
    std::optional<std::uint64_t> shuffle;
    std::string cameras;
    std::string sharing = "auto";
    std::string preset = "default";
    std::string log;
    std::string vocabulary;
    std::string history = "poses";
    bool batch = false;
    bool deterministic = false;
    bool fix_intrinsics = false;
    bool watch = false;
    int threads = 0;
    std::uint64_t seed = 0;
};

const std::map<std::string, History> kHistories{
    {"none", History::kNone}, {"poses", History::kPoses}, {"full", History::kFull}};

Result<SessionConfig> config_from(const RunArguments& arguments) {
    SessionConfig config;
    config.preset = arguments.preset;
    config.camera_sharing = *camera_sharing_from_name(arguments.sharing);
    config.fix_intrinsics = arguments.fix_intrinsics;
    config.deterministic = arguments.deterministic;
    config.batch = arguments.batch;
    config.seed = arguments.seed;
    if (!arguments.vocabulary.empty())
        config.vocabulary_file = std::filesystem::absolute(arguments.vocabulary).string();
    if (!arguments.cameras.empty()) {
        auto cameras = read_given_cameras(arguments.cameras);
        if (!cameras.ok()) return cameras.error();
        config.given_cameras = *std::move(cameras);
    }
    if (!arguments.order_file.empty()) {
        auto order = read_order_file(arguments.order_file);
        if (!order.ok()) return order.error();
        config.order = *std::move(order);
    } else if (arguments.shuffle) {
        const auto listing = list_photos(arguments.photos);
        if (!listing.ok()) return listing.error();
        std::vector<std::string> names;
        for (const PhotoFile& photo : listing->photos) names.push_back(photo.name);
        config.order = shuffled_names(std::move(names), *arguments.shuffle);
    }
    return config;
}

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
    if (begun.vocabulary_file != asked.vocabulary_file) return differs("--vocabulary");
    for (const auto& [name, given] : begun.given_cameras)
        asked.given_cameras.try_emplace(name, given);
    return asked;
}

int run(const RunArguments& arguments) {
    auto config = config_from(arguments);
    if (!config.ok()) return report_error(config.error(), ErrorOrigin::kOtherInput);
    if (!arguments.watch) {
        // Before a session is made: a mistyped folder leaves nothing behind.
        if (const auto listing = list_photos(arguments.photos); !listing.ok())
            return report_error(listing.error(), ErrorOrigin::kOtherInput);
    }
    StoreOptions store_options;
    store_options.history = kHistories.at(arguments.history);
    auto store = SessionStore::open(arguments.session, store_options);
    if (!store.ok()) return report_error(store.error());
    const auto settings = (*store)->settings();
    const bool is_new = !settings.ok() && settings.error().code == ErrorCode::kNotFound;
    if (!settings.ok() && !is_new) return report_error(settings.error());
    if (!is_new) {
        const auto begun = decode_config(settings->settings_json);
        if (!begun.ok()) return report_error(begun.error());
        config = continue_config(*begun, *std::move(config));
        if (!config.ok()) return report_error(config.error(), ErrorOrigin::kOtherInput);
    }
    const SessionSettings stored{
        std::filesystem::absolute(arguments.photos).lexically_normal().string(),
        encode_config(*config)};
    if (const auto done = (*store)->put_settings(stored); !done.ok())
        return report_error(done.error());

    RunRequest request;
    request.session = arguments.session;
    request.photos = arguments.photos;
    request.config = *std::move(config);
    request.execution.threads = arguments.threads;
    request.log_file = arguments.log;
    request.watch = arguments.watch;
    return run_and_report(**store, request);
}

}  // namespace

void add_run_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "run", "Reconstruct photographs, one after the other, in a session that is kept on disk");
    auto arguments = std::make_shared<RunArguments>();
    command
        ->add_option("IMAGES", arguments->photos, "Folder of photographs; sub-folders are included")
        ->required();
    command
        ->add_option("--session", arguments->session,
                     "Session folder: made when it does not exist, continued when it does")
        ->required();
    auto* order =
        command->add_option("--order", arguments->order_file,
                            "File with one image name a line: that order, and only those");
    command
        ->add_option("--shuffle", arguments->shuffle,
                     "Random order: names sorted, then shuffled with this seed")
        ->excludes(order);
    command->add_flag("--batch", arguments->batch,
                      "Solve only after the last photograph has arrived");
    command->add_flag("--deterministic", arguments->deterministic,
                      "Take every image through the whole graph before the next: same result on "
                      "any number of threads");
    command->add_option("--threads", arguments->threads, "Threads to use; 0: one a core")
        ->check(CLI::Range(0, 1024));
    command->add_option(
        "--cameras", arguments->cameras,
        "COLMAP model whose cameras give the photographs' intrinsics (its poses are not read)");
    command->add_flag("--fix-intrinsics", arguments->fix_intrinsics, "Never refine intrinsics");
    command
        ->add_option("--camera-sharing", arguments->sharing,
                     "Which photographs share intrinsics: auto (equal make, model, size and focal "
                     "length in EXIF), image, folder, all")
        ->check(CLI::IsMember({"auto", "image", "folder", "all"}));
    command
        ->add_option("--preset", arguments->preset,
                     "default, or paper: the clustering distance exactly as published")
        ->check(CLI::IsMember({"default", "paper"}));
    command->add_option("--vocabulary", arguments->vocabulary,
                        "Vocabulary made by `psfm vocabulary train`; without one it is trained "
                        "from the session's own images above 100");
    command
        ->add_option("--history", arguments->history,
                     "What is kept of every version: none, poses, full (points, too)")
        ->check(CLI::IsMember({"none", "poses", "full"}));
    command->add_flag(
        "--watch", arguments->watch,
        "Keep waiting for more photographs to be copied into the folder, until Ctrl-C");
    command->add_option("--log", arguments->log, "Append a log of JSON lines to this file");
    command->add_option("--seed", arguments->seed, "Seed of everything random");
    command->footer(
        "Examples:\n"
        "  psfm run photos --session castle\n"
        "  psfm run photos --session castle --cameras calibration --fix-intrinsics\n"
        "  psfm run incoming --session live --watch --log live.jsonl\n"
        "A session can be continued with more photographs by the same command; those it has are "
        "skipped.\n"
        "Ctrl-C stops in order: `psfm resume --session DIR` goes on.");
    command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace psfm
