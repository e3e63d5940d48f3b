// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "graph/wording.h"
#include "scheduler/session/remove_images.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/shell_word.h"
#include "tools/commands/session/session_options.h"
#include "tools/commands/session/session_runner.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

struct RemoveArguments {
    std::string session;
    std::vector<std::string> names;
    std::string log;
    bool undo = false;
    bool again = false;
    int threads = 0;
    std::size_t cache_mib = StoreOptions{}.cache_bytes >> 20U;
};

/// What the session knows a photograph by: its name, or the path of its file as a shell completes
/// it.
std::string name_in_session(const std::string& given, const std::string& photo_folder) {
    std::error_code unknown;
    const fs::path absolute = fs::absolute(given, unknown).lexically_normal();
    const std::string relative =
        unknown ? std::string() : absolute.lexically_relative(photo_folder).generic_string();
    return relative.empty() || relative.starts_with("..") ? given : relative;
}

/// The images of these names: of those that were removed and may not come in again, or of those
/// that were not.
/// @errors kNotFound (names one that is not there)
Result<std::vector<SourcedImage>> find_images(const SessionReader& store,
                                              const std::vector<std::string>& names,
                                              const std::string& photo_folder, bool removed) {
    const auto images = store.images();
    if (!images.ok()) return images.error();
    const auto sources = store.image_sources();
    if (!sources.ok()) return sources.error();
    std::multimap<std::string, ImageId> by_name;
    for (const Image& image : *images) {
        if ((*sources)[index_of(image.id)].removed != removed) continue;
        const bool may_come_in = removed && image.metadata.content_hash == 0;  // as take_back
        if (!may_come_in) by_name.emplace(image.name, image.id);
    }
    std::set<ImageId> found;
    for (const std::string& given : names) {
        std::string name = given;
        if (!by_name.contains(name)) name = name_in_session(given, photo_folder);
        const auto [first, last] = by_name.equal_range(name);
        if (first == last) {
            return Error{ErrorCode::kNotFound,
                         removed
                             ? given + " is not kept out of the session: there is nothing to undo"
                             : given +
                                   " is no image of the session; 'psfm status' names those "
                                   "that wait or were rejected"};
        }
        for (auto image = first; image != last; ++image) found.insert(image->second);
    }
    std::vector<SourcedImage> result;
    result.reserve(found.size());
    for (const ImageId id : found)
        result.push_back({(*images)[index_of(id)], (*sources)[index_of(id)]});
    return result;
}

/// They may come in again: neither their names nor their contents are kept out.
int take_back(SessionStore& store, std::vector<SourcedImage> images,
              const RemoveArguments& arguments, const std::string& photo_folder) {
    std::set<std::uint64_t> contents;
    for (SourcedImage& image : images)
        contents.insert(std::exchange(image.image.metadata.content_hash, 0));
    const auto rejected = store.rejected();
    if (!rejected.ok()) return report_error(rejected.error());
    std::vector<std::string> names;  // it may have been met under others since
    for (const RejectedPhoto& photo : *rejected) {
        if (contents.contains(photo.content_hash)) names.push_back(photo.name);
    }
    if (const auto done = store.commit_files(images); !done.ok()) return report_error(done.error());
    if (const auto done = store.forget_rejected(names); !done.ok())
        return report_error(done.error());
    std::cout << counted(images.size(), "photograph") << " may come in again: "
              << command_line("run " + shell_word(photo_folder), arguments.session) << '\n';
    return 0;
}

/// Takes them out. @return the exit code where there is nothing else to do
std::optional<int> take_out(SessionStore& store, const RemoveArguments& arguments,
                            RunRequest& request) {
    const auto settings = store.settings();
    if (!settings.ok()) return report_error(settings.error());
    auto config = decode_config(settings->settings_json);
    if (!config.ok()) return report_error(config.error());
    request.input = settings->photo_folder;
    request.config = *std::move(config);
    auto images = find_images(store, arguments.names, settings->photo_folder, arguments.undo);
    if (!images.ok()) return report_error(images.error(), ErrorOrigin::kOtherInput);
    if (arguments.undo)
        return take_back(store, *std::move(images), arguments, settings->photo_folder);
    const auto sources = store.image_sources();
    if (!sources.ok()) return report_error(sources.error());
    const auto left =
        std::ranges::count_if(*sources, [](const ImageSource& source) { return !source.removed; });
    if (static_cast<std::size_t>(left) == images->size()) {
        return report_error(
            {ErrorCode::kInvalidArgument,
             "these are all images of the session; delete " + arguments.session + " instead"},
            ErrorOrigin::kOtherInput);
    }
    std::vector<ImageId> ids;
    for (const SourcedImage& image : *images) ids.push_back(image.image.id);
    const auto removal = remove_images(store, request.config, ids, !arguments.again);
    if (!removal.ok()) return report_error(removal.error());
    std::cout << counted(ids.size(), "photograph") << " removed; "
              << counted(removal->clusters, "cluster") << " to be solved anew\n"
              << std::flush;
    return std::nullopt;
}

int remove(const RemoveArguments& arguments) {
    StoreOptions store_options;
    store_options.cache_bytes = arguments.cache_mib << 20U;
    RunRequest request;
    request.session = arguments.session;
    request.execution = execution_of(arguments.threads, store_options);
    request.log_file = arguments.log;
    request.go_on_command = command_line("resume", request.session);
    request.may_place_none = true;
    auto store = SessionStore::open_existing(arguments.session, store_options);
    if (!store.ok()) return report_error(store.error());
    if (const auto code = take_out(**store, arguments, request)) return *code;
    return run_and_report(**store, request);
}

}  // namespace

void add_remove_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "remove", "Take photographs out of a session again, and solve what they took part in anew");
    auto arguments = std::make_shared<RemoveArguments>();
    command->add_option("--session", arguments->session, "Session folder")->required();
    command
        ->add_option("NAME", arguments->names,
                     "Names as 'psfm status' and exports have them, or paths of the files")
        ->required();
    auto* again = command->add_flag(
        "--again", arguments->again,
        "Let them come in again with the next `psfm run`, e.g. to use masks that are new");
    command->add_flag("--undo", arguments->undo, "The same of photographs that were removed before")
        ->excludes(again);
    command->add_option("--threads", arguments->threads, "Threads to use; 0: one a core")
        ->check(CLI::Range(0, 1024));
    add_cache_option(*command, arguments->cache_mib);
    command->add_option("--log", arguments->log, "Append a log of JSON lines to this file");
    command->footer(
        "Files are left alone. What was removed stays out, whatever its file is called, until "
        "--undo;\nan edited file is another photograph, and comes in with the next run.\n"
        "Example: psfm remove --session castle blurred/IMG_0007.jpg IMG_0012.jpg");
    command->callback([arguments, &exit_code] { exit_code = remove(*arguments); });
}

}  // namespace psfm
