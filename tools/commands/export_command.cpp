// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <cstdint>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "graph/wording.h"
#include "scheduler/session/photo_folders.h"
#include "scheduler/session/session_config.h"
#include "storage/exchange/models/dataset_model.h"
#include "storage/exchange/models/distinct_points.h"
#include "storage/exchange/models/export_models.h"
#include "storage/exchange/models/write_models.h"
#include "storage/session/session_store.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/exit_codes.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/exchange/export_database.h"
#include "tools/commands/exchange/export_dataset.h"
#include "tools/commands/exchange/geo_files.h"
#include "tools/commands/exchange/geo_report.h"
#include "tools/commands/exchange/output_folder.h"

namespace psfm {
namespace {

struct ExportArguments {
    std::string session;
    std::string format;
    std::string output;
    std::optional<std::uint32_t> after_image;
    bool points_only = false;
    DatasetArguments dataset;
};

Result<Scene> scene_to_export(const SessionReader& session, const ExportArguments& arguments) {
    return arguments.after_image ? session.scene_after(*arguments.after_image) : session.scene();
}

Error no_model(const ExportArguments& arguments, std::size_t waiting) {
    const std::string when =
        arguments.after_image ? "had no model after image " + std::to_string(*arguments.after_image)
                              : std::string("has no model yet");
    return {ErrorCode::kNotFound, arguments.session + ": the session " + when + ": " +
                                      counted(waiting, "image") +
                                      " waiting; `psfm status` says why"};
}

/// Points that a file of the format has.
std::size_t written_points(const ExportedModel& model, ExportFormat format) {
    if (point_coordinates(format) != PointCoordinates::kDistinctFloats) return model.points.size();
    return distinct_points(model.points, float_origin(model)).size();
}

void print_summary(const std::vector<ExportedModel>& models, ExportFormat format,
                   const std::vector<std::filesystem::path>& written) {
    for (std::size_t i = 0; i < models.size(); ++i) {
        std::cout << written[i].string() << ": " << counted(models[i].images.size(), "image")
                  << ", " << counted(written_points(models[i], format), "point") << '\n';
    }
    std::cout << std::flush;
}

/// How many of the models' photographs the folder has not.
std::size_t photographs_elsewhere(const std::vector<ExportedModel>& models,
                                  const std::filesystem::path& folder) {
    std::size_t elsewhere = 0;
    for (const ExportedModel& model : models) {
        elsewhere += static_cast<std::size_t>(
            std::ranges::count_if(model.images, [&](const ExportedImage& image) {
                return !find_photo(std::span(&folder, 1), image.name);
            }));
    }
    return elsewhere;
}

/// The folder that a link of theirs leads to: the one that has most; empty when none has any.
std::filesystem::path folder_of_most(const std::vector<ExportedModel>& models,
                                     const std::vector<std::filesystem::path>& folders) {
    std::filesystem::path best;
    std::size_t fewest = 0;
    for (const ExportedModel& model : models) fewest += model.images.size();
    for (const auto& folder : folders) {
        const std::size_t elsewhere = photographs_elsewhere(models, folder);
        if (elsewhere >= fewest) continue;
        fewest = elsewhere;
        best = folder;
    }
    return best;
}

/// Of a link to one folder, photographs that are not in it are missing.
void tell_photographs_elsewhere(const std::vector<ExportedModel>& models,
                                const std::filesystem::path& folder) {
    if (folder.empty()) {
        std::cerr << "psfm: the session does not know where its photographs are: make `images` a "
                     "link to their folder, beside each transforms.json\n";
        return;
    }
    const std::size_t elsewhere = photographs_elsewhere(models, folder);
    if (elsewhere == 0) return;
    std::cerr << "psfm: " << counted(elsewhere, "photograph") << (elsewhere == 1 ? " is" : " are")
              << " not in " << folder.string()
              << ", which `images` leads to; `--format dataset` has those of all folders\n";
}

int run_export(const CLI::App& command, const ExportArguments& arguments) {
    if (arguments.points_only && arguments.format != "ply") {
        std::cerr << "psfm: --points-only goes with --format ply only\n";
        return kUsageError;
    }
    if (const auto possible = check_output_folder(arguments.output, arguments.session);
        !possible.ok())
        return report_error(possible.error(), ErrorOrigin::kOtherInput);
    if (arguments.format == kDatasetFormat) {
        return export_dataset(arguments.session, arguments.output, arguments.after_image,
                              arguments.dataset);
    }
    if (const auto option = given_dataset_option(command)) {
        std::cerr << "psfm: " << *option << " goes with --format dataset only\n";
        return kUsageError;
    }
    if (arguments.format == kDatabaseFormat) {
        if (!arguments.after_image) return export_database(arguments.session, arguments.output);
        std::cerr << "psfm: --after-image is about models, and a database has none: leave it out, "
                     "or choose another format\n";
        return kUsageError;
    }
    const auto format = export_format_from_name(arguments.format);
    if (!format) return kUsageError;  // the option's check has refused it already
    const auto session = open_session_reader(arguments.session, StoreOptions{});
    if (!session.ok()) return report_error(session.error());
    if (const auto apart =
            check_apart_from_photographs(arguments.output, **session, arguments.session);
        !apart.ok())
        return report_error(apart.error(), ErrorOrigin::kOtherInput);
    const auto scene = scene_to_export(**session, arguments);
    if (!scene.ok()) return report_error(scene.error());
    const auto images = (*session)->images();
    if (!images.ok()) return report_error(images.error());
    const auto settings = (*session)->settings();
    if (!settings.ok()) return report_error(settings.error());

    auto models = export_models(
        *scene, *images, [&](ImageId image) { return (*session)->keypoints(image); },
        feature_use(*format));
    if (!models.ok()) return report_error(models.error());
    if (models->empty()) return report_error(no_model(arguments, scene->image_count));
    if (arguments.after_image.value_or(0) > images->size()) {
        std::cerr << "psfm: the session has taken in " << counted(images->size(), "image")
                  << "; this is its latest model\n";
    }
    const bool any_points = std::ranges::any_of(
        *models, [](const ExportedModel& model) { return !model.points.empty(); });
    if (!any_points && !arguments.after_image) {
        std::cerr << "psfm: the model has no points, since the one that the session began with "
                     "had none; they come with photographs that are joined to it\n";
    } else if (!any_points) {
        std::cerr
            << "psfm: only poses of this version are kept, so the export has no points; a session "
               "made with --history full keeps them\n";
    }
    const auto known =
        std::span(*images).first(std::min<std::size_t>(scene->image_count, images->size()));
    const auto reference = world_reference_of(*models, known);
    const auto folders = photo_folders(**session, arguments.session);
    if (!folders.ok()) return report_error(folders.error());
    WriteModelsOptions options{
        .photo_folder = *format == ExportFormat::kNerfstudio ? folder_of_most(*models, *folders)
                                                             : std::filesystem::path(),
        .ply = arguments.points_only ? PlyContents::kPoints : PlyContents::kPointsAndCameras};
    std::vector<GeoPart> parts;
    for (const ExportedModel& model : *models) {
        const bool floats = point_coordinates(*format) != PointCoordinates::kDoubles;
        parts.push_back(
            {parts.size(), &model, floats ? float_origin(model) : Eigen::Vector3d::Zero()});
        options.up.push_back(up_in_model(model, known, reference.has_value()));
    }
    const std::optional<bool> share = arguments.dataset.share_location;
    const bool tells = tells_location(arguments.session, share);
    if (tells) options.geo_files = geo_files(reference, parts, known);
    const auto config = decode_config(settings->settings_json);
    const bool colmap = *format == ExportFormat::kColmap || *format == ExportFormat::kColmapText;
    if (!config.ok()) {
        std::cerr << "psfm: " << config.error().message << "; images have the session's numbers\n";
    } else if (colmap && !config->image_ids.empty()) {
        const auto sources = (*session)->image_sources();
        if (!sources.ok()) return report_error(sources.error());
        for (ExportedModel& model : *models) {
            add_remainders(model, *sources);
            add_repeated(model, config->repeated_observations);
            model = renumbered(std::move(model), config->image_ids, config->camera_ids);
        }
    }
    const auto written = write_models(*models, *format, arguments.output, options);
    if (!written.ok()) return report_error(written.error(), ErrorOrigin::kOtherInput);
    print_summary(*models, *format, *written);
    if (!options.geo_files.empty())
        std::cout << arguments.output << "/geo.txt: " << describe(*reference) << '\n' << std::flush;
    if (const std::string trouble = position_trouble(reference, *models, known); !trouble.empty())
        std::cerr << "psfm: " << trouble << '\n';
    if (const std::string hint = tells ? "" : location_hint(reference, share); !hint.empty())
        std::cerr << "psfm: " << hint << '\n';
    if (*format == ExportFormat::kNerfstudio)
        tell_photographs_elsewhere(*models, options.photo_folder);
    return 0;
}

}  // namespace

void add_export_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "export", "Write a session's model, or its features and matches, for other programs");
    const auto arguments = std::make_shared<ExportArguments>();
    command
        ->add_option("--session", arguments->session, "the session; it may be in use by `psfm run`")
        ->required()
        ->type_name("DIR");
    const auto models = export_format_names();
    std::vector<std::string> names(models.begin(), models.end());
    names.emplace_back(kDatabaseFormat);
    names.emplace_back(kDatasetFormat);
    command->add_option("--format", arguments->format, "what to write")
        ->required()
        ->type_name("FORMAT")
        ->check(CLI::IsMember(names));
    command->add_option("--output", arguments->output, "folder to write into; made if need be")
        ->required()
        ->type_name("DIR");
    command
        ->add_option("--after-image", arguments->after_image,
                     "the model as it was after this many images, instead of the latest one")
        ->check(CLI::Range(1U, std::numeric_limits<std::uint32_t>::max()))
        ->type_name("N");
    command->add_flag("--points-only", arguments->points_only,
                      "--format ply without the camera centres, which splatting would begin with");
    CLI::Option* share = command->add_flag_callback(
        "--share-location", [arguments] { arguments->dataset.share_location = true; },
        "say where on the earth the models stand, even if users have sent photographs to the "
        "session");
    command
        ->add_flag_callback(
            "--no-location", [arguments] { arguments->dataset.share_location = false; },
            "do not say it, even if nobody has")
        ->excludes(share);
    add_dataset_options(*command, arguments->dataset);
    command->footer(
        "One model an effective cluster, largest first:\n"
        "  colmap, colmap-text  OUTPUT/0, OUTPUT/1, ...: open them with COLMAP and its friends\n"
        "  ply                  OUTPUT/0.ply, ...: coloured points, camera centres in green\n"
        "  nvm                  OUTPUT/0.nvm, ...: VisualSFM and many multi-view stereo programs\n"
        "  bundler              OUTPUT/0/bundle.out and list.txt, ...\n"
        "  nerfstudio           OUTPUT/0/transforms.json and sparse_pc.ply, ...: also instant-ngp\n"
        "  gltf                 OUTPUT/0.gltf and 0.bin, ...: Blender and web viewers\n"
        "For Gaussian splatting and multi-view stereo:\n"
        "  dataset              OUTPUT/0, ...: undistorted upright pictures, COLMAP's and\n"
        "                       nerfstudio's model of them; again later: what has changed only\n"
        "No model, but what models are made of:\n"
        "  colmap-database      OUTPUT/database.db: cameras, images, features and verified "
        "matches,\n"
        "                       for `colmap mapper` and its friends\n"
        "Where photographs have GPS positions, OUTPUT/geo.txt tells where on the earth models "
        "stand,\n"
        "unless users of `psfm serve` have sent some: then with --share-location only.\n"
        "An earlier export in the same folder is replaced as a whole, of whatever format it is;\n"
        "other files there are left alone, and nothing is written through links.\n"
        "\n"
        "Examples:\n"
        "  psfm export --session my-session --format colmap --output exported\n"
        "  psfm export --session my-session --format ply --output early --after-image 20\n"
        "  psfm export --session my-session --format dataset --output train-me --reduced 2 4 8\n"
        "  psfm export --session my-session --format colmap-database --output for-colmap");
    command->callback(
        [command, arguments, &exit_code] { exit_code = run_export(*command, *arguments); });
}

}  // namespace psfm
