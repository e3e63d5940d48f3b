// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <array>
#include <iostream>
#include <memory>

#include "graph/wording.h"
#include "stages/evaluation/evaluate_model.h"
#include "stages/evaluation/pose_auc.h"
#include "storage/exchange/models/export_models.h"
#include "storage/exchange/models/read_colmap.h"
#include "storage/session/session_store.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/evaluation_report.h"
#include "tools/commands/console/report_error.h"

namespace psfm {
namespace {

/// Format: limits that papers on matching and SfM report areas for.
constexpr std::array<double, 4> kAucLimitsDeg{1.0, 3.0, 5.0, 10.0};

struct EvaluateArguments {
    std::string reference;
    std::vector<std::string> models;
    std::string session;
    bool every_image = false;
    bool json = false;
};

/// A model as evaluation sees it.
struct NamedModel {
    std::string name;
    std::vector<NamedPose> poses;
    std::size_t points = 0;
};

NamedModel named_model(std::string name, const ExportedModel& model) {
    NamedModel named{std::move(name), {}, model.points.size()};
    named.poses.reserve(model.images.size());
    for (const ExportedImage& image : model.images) {
        named.poses.push_back({image.name, image.cam_from_world});
    }
    return named;
}

/// Poses only: neither cameras nor features matter, so camera models beyond psfm's are welcome.
Result<NamedModel> read_named_model(const std::filesystem::path& folder) {
    const auto model = read_colmap_model(folder, {.cameras = false, .keypoints = false});
    if (!model.ok()) return model.error();
    return named_model(folder.string(), *model);
}

Result<std::vector<NamedModel>> read_named_models(const std::vector<std::string>& paths) {
    std::vector<NamedModel> models;
    for (const std::string& path : paths) {
        const auto folders = find_colmap_models(path);
        if (!folders.ok()) return folders.error();
        for (const std::filesystem::path& folder : *folders) {
            auto model = read_named_model(folder);
            if (!model.ok()) return model.error();
            models.push_back(*std::move(model));
        }
    }
    return models;
}

/// The effective clusters of a scene, largest first.
Result<std::vector<NamedModel>> named_models(const Scene& scene, const std::vector<Image>& images) {
    const auto exported = export_models(scene, images, {}, FeatureUse::kNone);
    if (!exported.ok()) return exported.error();
    std::vector<NamedModel> models;
    for (const ExportedModel& model : *exported) {
        models.push_back(named_model("effective cluster " + std::to_string(models.size()), model));
    }
    return models;
}

EvaluatedModel evaluate(const NamedModel& reference, const NamedModel& model) {
    return {model.name, model.poses.size(), model.points,
            evaluate_model(reference.poses, model.poses)};
}

/// One entry a kept version: those after 1, 2, … images, without repetition.
Result<std::vector<EvaluatedVersion>> evaluate_versions(const NamedModel& reference,
                                                        const SessionReader& session,
                                                        const std::vector<Image>& images) {
    std::vector<EvaluatedVersion> versions;
    for (std::uint32_t count = 1; count <= images.size(); ++count) {
        const auto scene = session.scene_after(count);
        if (!scene.ok() && scene.error().code == ErrorCode::kNotFound) continue;
        if (!scene.ok()) return scene.error();
        if (scene->image_count != count)
            continue;  // an earlier version, which is in the list already
        const auto models = named_models(*scene, images);
        if (!models.ok()) return models.error();
        std::vector<std::vector<NamedPose>> poses;
        for (const NamedModel& model : *models) poses.push_back(model.poses);
        const auto outliers = summed_outliers(reference.poses, poses);
        if (!outliers.ok()) return outliers.error();
        EvaluatedVersion version{
            count, placed_count(*scene), scene->effective_clusters, *outliers, {}};
        if (!models->empty()) version.largest = evaluate(reference, models->front());
        versions.push_back(std::move(version));
    }
    return versions;
}

/// A missing model in words a person can act upon.
Error no_model_yet(const std::string& session, std::size_t images) {
    return {ErrorCode::kNotFound,
            session + ": the session has no model yet: " + counted(images, "image") +
                " waiting; `psfm status` says why"};
}

int run_evaluate(const EvaluateArguments& arguments) {
    const auto reference_folders = find_colmap_models(arguments.reference);
    if (!reference_folders.ok())
        return report_error(reference_folders.error(), ErrorOrigin::kOtherInput);
    const auto reference = read_named_model(reference_folders->front());
    if (!reference.ok()) return report_error(reference.error(), ErrorOrigin::kOtherInput);
    if (const auto usable = outlier_threshold(reference->poses, {}); !usable.ok()) {
        return report_error(
            {usable.error().code, arguments.reference + ": " + usable.error().message},
            ErrorOrigin::kOtherInput);
    }

    EvaluationReport report;
    report.reference = arguments.reference;
    report.reference_cameras = reference->poses.size();
    std::vector<NamedModel> models;
    if (!arguments.session.empty()) {
        const auto session = open_session_reader(arguments.session, StoreOptions{});
        if (!session.ok()) return report_error(session.error());
        const auto scene = (*session)->scene();
        if (!scene.ok()) return report_error(scene.error());
        const auto images = (*session)->images();
        if (!images.ok()) return report_error(images.error());
        auto in_session = named_models(*scene, *images);
        if (!in_session.ok()) return report_error(in_session.error());
        models = *std::move(in_session);
        if (models.empty()) return report_error(no_model_yet(arguments.session, images->size()));
        if (arguments.every_image) {
            auto versions = evaluate_versions(*reference, **session, *images);
            if (!versions.ok()) return report_error(versions.error());
            report.versions = *std::move(versions);
        }
    } else {
        auto read = read_named_models(arguments.models);
        if (!read.ok()) return report_error(read.error(), ErrorOrigin::kOtherInput);
        models = *std::move(read);
    }

    bool any_judged = false;
    for (const NamedModel& model : models) {
        report.models.push_back(evaluate(*reference, model));
        any_judged = any_judged || report.models.back().evaluation.ok();
    }
    report.auc_limits_deg.assign(kAucLimitsDeg.begin(), kAucLimitsDeg.end());
    report.auc = relative_pose_auc(reference->poses, models.front().poses, kAucLimitsDeg);
    std::cout << (arguments.json ? to_json(report) : to_table(report)) << std::flush;
    if (any_judged) return 0;
    const EvaluatedModel& first = report.models.front();
    return report_error(
        {first.evaluation.error().code, first.name + ": " + first.evaluation.error().message},
        ErrorOrigin::kOtherInput);
}

}  // namespace

void add_evaluate_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand("evaluate", "Compare models with known camera poses");
    const auto arguments = std::make_shared<EvaluateArguments>();
    command
        ->add_option(
            "--reference", arguments->reference,
            "COLMAP model with the known poses (binary or text); images are matched by name")
        ->required()
        ->type_name("DIR");
    CLI::Option* models =
        command
            ->add_option(
                "model", arguments->models,
                "COLMAP models to judge; a folder with sub-folders 0, 1, ... stands for those")
            ->type_name("MODEL");
    CLI::Option* session =
        command
            ->add_option("--session", arguments->session,
                         "judge the effective clusters of a session, largest first")
            ->type_name("DIR");
    models->excludes(session);
    command
        ->add_flag(
            "--every-image", arguments->every_image,
            "also judge what the session looked like after each image (needs --history poses)")
        ->needs(session);
    command->add_flag("--json", arguments->json, "one JSON object instead of a table");
    command->footer(
        "Each model is aligned to the reference by a similarity between camera centres (RANSAC, "
        "then least\n"
        "squares on the inliers). A camera is an outlier when it is off by more than half the "
        "smallest\n"
        "distance between two cameras of the reference. AUC is that of the first model: the area "
        "under the\n"
        "recall curve of relative pose errors over all image pairs, missing images counting as "
        "failures.\n"
        "\n"
        "Examples:\n"
        "  psfm evaluate --reference fountain/gt exported/0\n"
        "  psfm evaluate --reference fountain/gt --json colmap/sparse psfm/export\n"
        "  psfm evaluate --reference temple/gt --session my-session --every-image --json");
    command->callback([arguments, command, models, session, &exit_code] {
        if (models->count() == 0 && session->count() == 0) {
            throw CLI::RequiredError(command->get_name() + ": a MODEL or --session");
        }
        exit_code = run_evaluate(*arguments);
    });
}

}  // namespace psfm
