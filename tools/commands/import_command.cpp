// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>

#include "storage/exchange/colmap_database.h"
#include "tools/commands/commands.h"
#include "tools/commands/report_error.h"
#include "tools/commands/session_options.h"

namespace psfm {
namespace {

struct ImportArguments {
    SessionArguments session;
    std::string database;
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

int import(const CLI::App& command, const ImportArguments& arguments) {
    const auto database = ColmapDatabase::open(arguments.database);
    if (!database.ok()) return report_error(database.error(), ErrorOrigin::kOtherInput);
    auto config = config_from(arguments.session, [&] {
        std::vector<std::string> names;
        for (const DatabaseImage& image : (*database)->images()) names.push_back(image.name);
        return Result<std::vector<std::string>>(std::move(names));
    });
    if (!config.ok()) return report_error(config.error(), ErrorOrigin::kOtherInput);
    config->colmap_database =
        std::filesystem::absolute(arguments.database).lexically_normal().string();
    config->given_cameras = cameras_of(**database);
    return start_session(command, arguments.session, arguments.database, *std::move(config), false);
}

}  // namespace

void add_import_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "import", "Reconstruct from another program's features and verified matches");
    auto arguments = std::make_shared<ImportArguments>();
    command
        ->add_option("--colmap-database", arguments->database,
                     "COLMAP database; its images arrive by name, or as --order or --shuffle says")
        ->required()
        ->type_name("FILE");
    add_session_options(*command, arguments->session);
    command->footer(
        "Images, cameras, features and the verified matches (two_view_geometries) are read; the\n"
        "geometry of each pair is estimated anew. No photograph is needed. The session remembers\n"
        "the database: `psfm resume` goes on, and the same command adds images that are new in "
        "it.\n"
        "\n"
        "Examples:\n"
        "  psfm import --session castle --colmap-database castle.db\n"
        "  psfm import --session castle --colmap-database castle.db --shuffle 1 --deterministic");
    command->callback(
        [command, arguments, &exit_code] { exit_code = import(*command, *arguments); });
}

}  // namespace psfm
