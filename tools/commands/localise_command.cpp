// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <atomic>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string_view>

#include "scheduler/session/session_config.h"
#include "stages/algorithms/math/in_parallel.h"
#include "stages/features/photographs/photo_listing.h"
#include "stages/features/run_features.h"
#include "stages/localisation/localise_photo.h"
#include "storage/exchange/files/json_text.h"
#include "storage/session/session_store.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/exit_codes.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/thread_budget.h"
#include "tools/report/json_array.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct LocaliseArguments {
    std::string session;
    std::vector<std::string> photos;
    bool json = false;
    int threads = 0;
    std::size_t cache_mib = StoreOptions{}.cache_bytes >> 20U;
};

/// What of a session localisation needs, in memory.
struct OpenSession {
    std::unique_ptr<SessionReader> reader;
    SessionConfig config;
    std::vector<Image> images;
    std::unique_ptr<LocalisationMap> map;
    std::map<std::string, CameraId> camera_of_key;
    std::map<CameraId, Camera> cameras;  ///< as the model knows them
    /// Of these the ones whose images no EXIF names, as an import's.
    std::set<CameraId> unnamed;
};

Result<OpenSession> open_session(const LocaliseArguments& arguments) {
    OpenSession session;
    StoreOptions options;
    options.cache_bytes = arguments.cache_mib << 20U;
    auto reader = open_session_reader(arguments.session, options);
    if (!reader.ok()) return reader.error();
    session.reader = *std::move(reader);
    const auto settings = session.reader->settings();
    if (!settings.ok()) return settings.error();
    auto config = decode_config(settings->settings_json);
    if (!config.ok()) return config.error();
    session.config = *std::move(config);
    auto images = session.reader->images();
    if (!images.ok()) return images.error();
    session.images = *std::move(images);
    const auto scene = session.reader->scene();
    if (!scene.ok()) return scene.error();
    session.map = std::make_unique<LocalisationMap>(*scene);
    if (session.map->places().empty()) {
        return Error{ErrorCode::kNotFound,
                     arguments.session + ": the session has no model yet; `psfm status` says why"};
    }
    const bool has_points = std::ranges::any_of(scene->clusters, [](const auto& cluster) {
        return cluster->model && !cluster->model->points.empty();
    });
    if (!has_points) {
        return Error{ErrorCode::kNotFound,
                     arguments.session +
                         ": the model has no points that a photograph could be placed by, since "
                         "the one that the session began with had none"};
    }
    std::size_t with_descriptors = 0;
    for (const auto& [image, place] : session.map->places()) {
        const auto descriptors = session.reader->descriptors(image);
        if (!descriptors.ok()) return descriptors.error();
        if ((*descriptors)->rows() > 0) ++with_descriptors;
        session.map->add(image, **descriptors, {});
    }
    if (with_descriptors == 0) {
        return Error{ErrorCode::kNotFound,
                     arguments.session +
                         ": its images have no descriptors (an import's?), so "
                         "nothing can be recognised"};
    }
    session.map->finish();
    for (const Image& image : session.images) {
        const auto place = session.map->places().find(image.id);
        if (place == session.map->places().end()) continue;
        session.cameras.try_emplace(image.camera, place->second.camera);
        session.camera_of_key.try_emplace(
            camera_key(session.config.camera_sharing, image.metadata, image.name), image.camera);
        if (image.metadata.make.empty() && image.metadata.model.empty())
            session.unnamed.insert(image.camera);
    }
    return session;
}

/// What is to be localised.
struct AskedPhoto {
    PhotoFile photo;
    std::optional<Error> no_photo;  ///< of a folder that holds none
};

/// The photographs of a command line: files, and those of folders.
std::vector<AskedPhoto> photos_of(const std::vector<std::string>& arguments) {
    std::vector<AskedPhoto> photos;
    for (const std::string& argument : arguments) {
        std::error_code ignored;
        if (!fs::is_directory(argument, ignored)) {
            photos.push_back({{argument, argument}, std::nullopt});
            continue;
        }
        auto listing = list_photos(argument);
        if (!listing.ok()) {
            photos.push_back(
                {{argument, argument}, Error{ErrorCode::kUnreadable, listing.error().message}});
            continue;
        }
        for (PhotoFile& photo : listing->photos) {
            photo.name = (fs::path(argument) / photo.name).generic_string();
            photos.push_back({std::move(photo), std::nullopt});
        }
    }
    return photos;
}

/// The one camera of this size among those that no EXIF names.
const Camera* only_unnamed_of(const OpenSession& session, const PhotoMetadata& metadata) {
    const Camera* only = nullptr;
    for (const CameraId id : session.unnamed) {
        const Camera& camera = session.cameras.at(id);
        if (camera.width != metadata.width || camera.height != metadata.height) continue;
        if (only != nullptr) return nullptr;
        only = &camera;
    }
    return only;
}

/// The camera that the session knows for a photograph like this one; else what its EXIF tells.
/// @return and whether its focal length is a guess
std::pair<Camera, bool> camera_for(const OpenSession& session, const PhotoMetadata& metadata,
                                   const std::string& name, double unknown_focal) {
    const auto known =
        session.camera_of_key.find(camera_key(session.config.camera_sharing, metadata, name));
    if (known != session.camera_of_key.end()) {
        const Camera& camera = session.cameras.at(known->second);
        if (camera.width == metadata.width && camera.height == metadata.height)
            return {camera, false};
    }
    if (const Camera* camera = only_unnamed_of(session, metadata)) return {*camera, true};
    const Camera camera = initial_camera(metadata, unknown_focal);
    return {camera, camera.focal_source == FocalSource::kUnknown};
}

Result<LocalisedPhoto> localise(const OpenSession& session, const AskedPhoto& asked) {
    if (asked.no_photo) return *asked.no_photo;
    const PhotoFile& photo = asked.photo;
    const auto options = stage_options(session.config);
    if (!options.ok()) return options.error();
    const auto extracted = run_features(photo, options->features);
    if (!extracted.ok()) return extracted.error();
    const std::string name = fs::path(photo.name).filename().string();
    const auto [camera, is_guess] =
        camera_for(session, extracted->metadata, name, options->features.unknown_focal);
    return localise_photo(
        *session.map, *extracted, camera, is_guess,
        [&](ImageId image) { return session.reader->descriptors(image); }, LocaliseOptions{});
}

Json json_of(const OpenSession& session, const PhotoFile& photo,
             const Result<LocalisedPhoto>& found) {
    Json json{{"name", photo.name}, {"localised", found.ok()}};
    if (!found.ok()) {
        json["reason"] = found.error().message;
        return json;
    }
    const Eigen::Quaterniond& rotation = found->cam_from_world.rotation;
    json["part"] = found->part;
    json["cam_from_world"] = {
        {"rotation_wxyz", {rotation.w(), rotation.x(), rotation.y(), rotation.z()}},
        {"translation", array_of(found->cam_from_world.translation)}};
    json["centre"] = array_of(found->cam_from_world.target_origin_in_source());
    json["covariance"] = nullptr;
    if (found->covariance) {
        Json rows = Json::array();
        for (int row = 0; row < 6; ++row) {
            Json values = Json::array();
            for (int column = 0; column < 6; ++column)
                values.push_back((*found->covariance)(row, column));
            rows.push_back(std::move(values));
        }
        json["covariance"] = std::move(rows);
    }
    json["inliers"] = found->inliers;
    json["correspondences"] = found->correspondences;
    json["median_error_px"] = found->median_error_px;
    Json params = Json::array();
    for (int i = 0; i < parameter_count(found->camera.model); ++i)
        params.push_back(found->camera.params.at(static_cast<std::size_t>(i)));
    json["camera"] = {{"model", model_name(found->camera.model)},
                      {"width", found->camera.width},
                      {"height", found->camera.height},
                      {"params", std::move(params)}};
    json["images"] = Json::array();
    for (const SeenImage& seen : found->images) {
        json["images"].push_back({{"name", session.images[index_of(seen.image)].name},
                                  {"matches", seen.matches},
                                  {"inliers", seen.inliers}});
    }
    return json;
}

std::string text_of(const OpenSession& session, const PhotoFile& photo,
                    const Result<LocalisedPhoto>& found) {
    std::ostringstream text;
    if (!found.ok()) {
        const std::string name = photo.name + ": ";
        std::string_view reason = found.error().message;
        if (reason.starts_with(name)) reason.remove_prefix(name.size());
        text << name << "not localised: " << reason;
        return text.str();
    }
    const Eigen::Vector3d centre = found->cam_from_world.target_origin_in_source();
    text << std::setprecision(7) << photo.name << ": part " << found->part << ", at " << centre.x()
         << ' ' << centre.y() << ' ' << centre.z();
    if (found->covariance) {
        text << std::setprecision(2) << " ± "
             << std::sqrt(found->covariance->bottomRightCorner<3, 3>().trace());
    }
    text << ", " << found->inliers << " inliers of " << found->correspondences << std::fixed
         << std::setprecision(2) << ", " << found->median_error_px << " px; sees";
    constexpr std::size_t kShown = 3;  // Format: names in a message
    for (std::size_t k = 0; k < std::min(kShown, found->images.size()); ++k)
        text << ' ' << session.images[index_of(found->images[k].image)].name;
    if (found->images.size() > kShown) text << " and " << found->images.size() - kShown << " more";
    return text.str();
}

int run_localise(const LocaliseArguments& arguments) {
    const ThreadBudget budget(arguments.threads);
    const auto session = open_session(arguments);
    if (!session.ok()) return report_error(session.error());
    const std::vector<AskedPhoto> photos = photos_of(arguments.photos);
    Json all = Json::array();
    std::size_t localised = 0;
    std::size_t readable = 0;
    // Guard: a few at a time, so that results come as they are found, and in order.
    constexpr std::size_t kAtOnce = 8;
    for (std::size_t first = 0; first < photos.size(); first += kAtOnce) {
        const std::size_t count = std::min(kAtOnce, photos.size() - first);
        std::vector<Result<LocalisedPhoto>> found(count, Error{});
        in_parallel(count,
                    [&](std::size_t k) { found[k] = localise(*session, photos[first + k]); });
        for (std::size_t k = 0; k < count; ++k) {
            const PhotoFile& photo = photos[first + k].photo;
            localised += found[k].ok() ? 1 : 0;
            // Expected: each photograph's error is in its row of what is printed
            readable += found[k].ok() || (found[k].error().code != ErrorCode::kIo &&
                                          found[k].error().code != ErrorCode::kUnreadable)
                            ? 1
                            : 0;
            if (arguments.json)
                all.push_back(json_of(*session, photo, found[k]));
            else
                std::cout << text_of(*session, photo, found[k]) << '\n' << std::flush;
        }
    }
    if (arguments.json) {
        const Json json{{"photos", std::move(all)}};
        std::cout << json_text(json, 1) << '\n';
    } else {
        std::cout << localised << " of " << photos.size() << " localised\n";
    }
    std::cout << std::flush;
    return readable == 0 ? kBadInput : 0;
}

}  // namespace

void add_localise_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "localise", "Where photographs were taken, by a session's model, which stays as it is");
    const auto arguments = std::make_shared<LocaliseArguments>();
    command
        ->add_option("--session", arguments->session, "the session; it may be in use by `psfm run`")
        ->required()
        ->type_name("DIR");
    command->add_option("photos", arguments->photos, "photographs, or folders of them")
        ->required()
        ->type_name("PHOTO");
    command->add_flag("--json", arguments->json, "one JSON object, for programs");
    command->add_option("--threads", arguments->threads, "threads to use (0: one a core)")
        ->check(CLI::Range(0, 1024))
        ->type_name("N");
    command->footer(
        "Nothing of the session is changed. For each photograph: its pose in the model's world, "
        "how\n"
        "sure that is, what agrees with it, and the images that it shares points with; or why "
        "there\n"
        "is none.\n"
        "\n"
        "Example:\n"
        "  psfm localise --session castle visitor.jpg --json");
    command->callback([arguments, &exit_code] { exit_code = run_localise(*arguments); });
}

}  // namespace psfm
