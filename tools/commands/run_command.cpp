// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>
#include <optional>

#include "stages/features/cameras/assign_camera.h"
#include "stages/features/photographs/masks_beside_photos.h"
#include "stages/features/photographs/photo_listing.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/exchange/export_dataset.h"
#include "tools/commands/exchange/given_cameras.h"
#include "tools/commands/exchange/output_folder.h"
#include "tools/commands/session/session_options.h"

namespace psfm {
namespace {

struct RunArguments {
    SessionArguments session;
    std::string photos;
    std::string cameras;
    std::string sharing = "auto";
    std::string vocabulary;
    std::string masks;
    std::string dataset_folder;  ///< empty: none is written
    DatasetArguments dataset;
    bool watch = false;
};

Result<std::vector<std::string>> photo_names(const std::string& folder, const std::string& masks) {
    auto listing = list_photos(folder);
    if (!listing.ok()) return listing.error();
    set_masks_aside((*listing).photos, masks);
    std::vector<std::string> names;
    for (const PhotoFile& photo : listing->photos) names.push_back(photo.name);
    return names;
}

Result<SessionConfig> config_from(const RunArguments& arguments) {
    auto config = config_from(arguments.session,
                              [&] { return photo_names(arguments.photos, arguments.masks); });
    if (!config.ok()) return config.error();
    config->camera_sharing = *camera_sharing_from_name(arguments.sharing);
    if (!arguments.vocabulary.empty())
        config->vocabulary_file = std::filesystem::absolute(arguments.vocabulary).string();
    if (!arguments.masks.empty())
        config->masks = std::filesystem::absolute(arguments.masks).lexically_normal().string();
    if (!arguments.cameras.empty()) {
        auto cameras = read_given_cameras(arguments.cameras);
        if (!cameras.ok()) return cameras.error();
        config->given_cameras = *std::move(cameras);
    }
    return config;
}

int run(const CLI::App& command, const RunArguments& arguments) {
    auto config = config_from(arguments);
    if (!config.ok()) return report_error(config.error(), ErrorOrigin::kOtherInput);
    std::error_code unknown;
    if (arguments.watch && !std::filesystem::is_directory(arguments.photos, unknown)) {
        return report_error(
            {ErrorCode::kNotFound,
             arguments.photos + ": there is no such folder; make it, then watch it"},
            ErrorOrigin::kOtherInput);
    }
    if (!arguments.masks.empty()) {
        const auto masks = match_masks(arguments.masks, {});
        if (!masks.ok()) return report_error(masks.error(), ErrorOrigin::kOtherInput);
    }
    if (!arguments.dataset_folder.empty()) {
        auto possible = check_output_folder(arguments.dataset_folder, arguments.session.session);
        if (possible.ok())
            possible = check_apart_from_photographs(arguments.dataset_folder, arguments.photos, {});
        if (!possible.ok()) return report_error(possible.error(), ErrorOrigin::kOtherInput);
    }
    const int code = start_session(command, arguments.session, arguments.photos, *std::move(config),
                                   arguments.watch);
    if (code != 0 || arguments.dataset_folder.empty()) return code;
    DatasetArguments dataset = arguments.dataset;
    dataset.threads = arguments.session.threads;
    dataset.as_before = true;
    dataset.masks = !arguments.masks.empty();
    return export_dataset(arguments.session.session, arguments.dataset_folder, std::nullopt,
                          dataset);
}

}  // namespace

void add_run_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "run", "Reconstruct photographs, one after the other, in a session that is kept on disk");
    auto arguments = std::make_shared<RunArguments>();
    command
        ->add_option("IMAGES", arguments->photos, "Folder of photographs; sub-folders are included")
        ->required();
    add_session_options(*command, arguments->session);
    command->add_option(
        "--cameras", arguments->cameras,
        "COLMAP model whose cameras give the photographs' intrinsics (its poses are not read)");
    command
        ->add_option("--camera-sharing", arguments->sharing,
                     "Which photographs share intrinsics: auto (equal make, model, size and focal "
                     "length in EXIF), image, folder, all")
        ->check(CLI::IsMember({"auto", "image", "folder", "all"}));
    command
        ->add_option("--masks", arguments->masks,
                     "Folder of masks: of a.jpg a.jpg.png, a_mask.png or a.png, black where no "
                     "feature is to be; kept with the session")
        ->type_name("DIR");
    command->add_option("--vocabulary", arguments->vocabulary,
                        "Vocabulary made by `psfm vocabulary train`; without one it is trained "
                        "from the session's own images above 100");
    CLI::Option* dataset =
        command
            ->add_option(
                "--dataset", arguments->dataset_folder,
                "In the end, also write the data set for Gaussian splatting there (as `psfm "
                "export --format dataset`)")
            ->type_name("DIR");
    add_dataset_size_options(*command, arguments->dataset, "Of --dataset");
    for (const char* option : {"--reduced", "--max-size"})
        command->get_option(option)->needs(dataset);
    command->add_flag(
        "--watch", arguments->watch,
        "Keep waiting for more photographs to be copied into the folder, until Ctrl-C");
    command->footer(
        "Examples:\n"
        "  psfm run photos --session castle\n"
        "  psfm run photos --session castle --cameras calibration --fix-intrinsics\n"
        "  psfm run photos --session castle --dataset train --reduced 2 4 8\n"
        "  psfm run incoming --session live --watch --log live.jsonl\n"
        "A session can be continued with more photographs by the same command; those it has are "
        "skipped.\n"
        "Ctrl-C stops in order: `psfm resume --session DIR` goes on.");
    command->callback([command, arguments, &exit_code] { exit_code = run(*command, *arguments); });
}

}  // namespace psfm
