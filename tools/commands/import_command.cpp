// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "graph/wording.h"
#include "storage/exchange/database/colmap_database.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/count_line.h"
#include "tools/commands/console/exit_codes.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/exchange/import_checks.h"
#include "tools/commands/exchange/import_model.h"
#include "tools/commands/session/session_options.h"

namespace psfm {
namespace {

struct ImportArguments {
    SessionArguments session;
    std::string database;
    std::string model;
    std::string images;
};

/// Every image has its intrinsics from the database; those with a prior focal length are refined
/// from there, the others are estimated.
std::map<std::string, GivenCamera> cameras_of(const ColmapDatabase& database) {
    std::map<std::string, GivenCamera> cameras;
    for (const DatabaseImage& image : database.images()) {
        cameras[image.name] = {"database/" + std::to_string(image.camera),
                               database.cameras().at(image.camera)};
    }
    return cameras;
}

/// Looks at all that a new session would take, so that none is begun with what cannot be read.
Result<void> check_contents(const ColmapDatabase& database, const std::string& session) {
    std::error_code ignored;
    if (std::filesystem::exists(session, ignored)) return {};
    CountLine line(" images of the database looked at", database.images().size());
    std::size_t without = 0;
    for (const DatabaseImage& image : database.images()) {
        const auto keypoints = database.keypoints(image.id);
        if (!keypoints.ok()) return keypoints.error();
        const auto descriptors = database.descriptors(image.id);
        if (!descriptors.ok()) return descriptors.error();
        without += !keypoints->empty() && descriptors->values.empty() ? 1 : 0;
        if (const auto found = database.matches(image.id); !found.ok()) return found.error();
        line.advance();
    }
    if (without > 0) {
        std::cerr << "psfm: " << counted(without, "image")
                  << " of the database without SIFT descriptors (128 bytes a feature): the matches "
                     "count, but no photograph can be localised in what is made of them\n";
    }
    return {};
}

Result<void> check_photographs_of(const ColmapDatabase& database, const std::string& folder) {
    if (folder.empty()) return {};
    ImportedNames images{.whose = "the database's", .names = {}};
    images.names.reserve(database.images().size());
    for (const DatabaseImage& image : database.images()) images.names.push_back(image.name);
    return check_photographs(folder, images, /*all_may_lack=*/false,
                             "; their features have no colours");
}

int import(const CLI::App& command, const ImportArguments& arguments) {
    if (!arguments.model.empty()) {
        return import_model(command, arguments.session,
                            {arguments.model, arguments.images, arguments.database});
    }
    if (arguments.database.empty()) {
        std::cerr << "psfm: import needs --colmap-database FILE, or --colmap-model DIR\n";
        return kUsageError;
    }
    const auto database = ColmapDatabase::open(arguments.database);
    if (!database.ok()) return report_error(database.error(), ErrorOrigin::kOtherInput);
    for (const auto& checked :
         {check_matches(**database, arguments.database, "`psfm run` on the photographs"),
          check_photographs_of(**database, arguments.images),
          check_contents(**database, arguments.session.session)}) {
        if (!checked.ok()) return report_error(checked.error(), ErrorOrigin::kOtherInput);
    }
    auto config = config_from(arguments.session, [&] {
        std::vector<std::string> names;
        for (const DatabaseImage& image : (*database)->images()) names.push_back(image.name);
        return Result<std::vector<std::string>>(std::move(names));
    });
    if (!config.ok()) return report_error(config.error(), ErrorOrigin::kOtherInput);
    const auto file = absolute_path(arguments.database);
    if (!file.ok()) return report_error(file.error(), ErrorOrigin::kOtherInput);
    config->colmap_database = file->string();
    if (!arguments.images.empty()) {
        const auto folder = absolute_path(arguments.images);
        if (!folder.ok()) return report_error(folder.error(), ErrorOrigin::kOtherInput);
        config->database_photos = folder->string();
    }
    config->given_cameras = cameras_of(**database);
    return start_session(command, arguments.session, arguments.database, *std::move(config), false);
}

}  // namespace

void add_import_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "import", "Begin from another program's model, or from its features and verified matches");
    auto arguments = std::make_shared<ImportArguments>();
    command
        ->add_option("--colmap-database", arguments->database,
                     "COLMAP database; its images arrive by name, or as --order or --shuffle says")
        ->type_name("FILE");
    command
        ->add_option("--colmap-model", arguments->model,
                     "COLMAP model to begin with: its frame, poses, cameras and points; needs "
                     "--images, and goes on with the photographs there that it has not")
        ->type_name("DIR");
    command
        ->add_option("--images", arguments->images,
                     "folder of the photographs: for colours, EXIF, and exports that need them")
        ->type_name("DIR");
    add_session_options(*command, arguments->session);
    command->footer(
        "Images, cameras, features and the verified matches (two_view_geometries) are read; the\n"
        "geometry of each pair is estimated anew. No photograph is needed, but points have their\n"
        "colours with --images only. The session remembers the database: `psfm resume` goes on,\n"
        "and the same command adds images that are new in it.\n"
        "\n"
        "Examples:\n"
        "  psfm import --session castle --colmap-database castle.db\n"
        "  psfm import --session castle --colmap-database castle.db --shuffle 1 --deterministic\n"
        "  psfm import --session castle --colmap-model sparse/0 --images photos");
    command->callback(
        [command, arguments, &exit_code] { exit_code = import(*command, *arguments); });
}

}  // namespace psfm
