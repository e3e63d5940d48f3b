// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/import_model.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>

#include "graph/wording.h"
#include "scheduler/front_end/begin_from_model.h"
#include "stages/features/photographs/photo_listing.h"
#include "storage/database/session_folder.h"
#include "storage/exchange/models/read_colmap.h"
#include "tools/commands/console/count_line.h"
#include "tools/commands/console/exit_codes.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/thread_budget.h"
#include "tools/commands/exchange/import_checks.h"
#include "tools/commands/exchange/model_checks.h"
#include "tools/commands/exchange/session_place.h"
#include "tools/commands/session/session_runner.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

struct FoundModel {
    fs::path folder;
    ExportedModel model;
};

/// The one model of a folder.
Result<FoundModel> read_one_model(const std::string& place) {
    const auto folders = find_colmap_models(place);
    if (!folders.ok()) return folders.error();
    if (folders->size() > 1) {
        return Error{ErrorCode::kInvalidArgument,
                     place + " has " + counted(folders->size(), "model") + ": name one of them, " +
                         folders->front().string() + " for instance"};
    }
    if (auto checked = check_points_are_there(folders->front()); !checked.ok())
        return checked.error();
    auto model = read_colmap_model(folders->front());
    if (!model.ok()) return model.error();
    return FoundModel{folders->front(), *std::move(model)};
}

Result<ForeignModel> read_model(const ModelImportArguments& arguments,
                                const ColmapDatabase* database) {
    auto found = read_one_model(arguments.model);
    if (!found.ok()) return found.error();
    const fs::path& folder = found->folder;
    ExportedModel& model = found->model;
    for (const ExportedCamera& camera : model.cameras) {
        if (const auto valid = validate(camera.camera); !valid.ok()) {
            return Error{ErrorCode::kDamaged, folder.string() + ": camera " +
                                                  std::to_string(camera.id) + ": " +
                                                  valid.error().message};
        }
    }
    if (model.images.size() < 2) {
        return Error{ErrorCode::kTooFewMatches,
                     arguments.model + " places " + counted(model.images.size(), "image") +
                         ": there is nothing to go on with; `psfm run` on the photographs"};
    }
    std::set<std::string> names;
    for (const ExportedImage& image : model.images) {
        if (names.insert(image.name).second) continue;
        return Error{ErrorCode::kDamaged, folder.string() + " has two images named " + image.name};
    }
    if (auto checked = check_geometry(model, folder); !checked.ok()) return checked.error();
    tell_of_spare_cameras(model);
    auto photographs = absolute_path(arguments.images);
    if (!photographs.ok()) return photographs.error();
    return ForeignModel{std::move(model), database, *std::move(photographs), folder};
}

std::optional<Failure> fill_session(const SessionArguments& session, const SessionPlace& place,
                                    const ForeignModel& foreign, SessionConfig config,
                                    BegunSession& begun) {
    StoreOptions options;
    options.cache_bytes = session.cache_mib << 20U;
    auto store = SessionStore::open(place.beside(), options);
    if (!store.ok()) return of_session(store.error());
    auto kept = (*store)->put_settings({foreign.photo_folder.string(), encode_config(config)});
    if (!kept.ok()) return of_session(kept.error());
    CountLine line(" images of the model taken over", foreign.model.images.size());
    auto made = begin_from_model(**store, foreign, config, [&] { line.advance(); });
    if (!made.ok()) return Failure{made.error()};
    begun = *std::move(made);
    config.repeated_observations = begun.repeated_observations;
    kept = (*store)->put_settings({foreign.photo_folder.string(), encode_config(config)});
    if (!kept.ok()) return of_session(kept.error());
    return std::nullopt;
}

/// Makes the session beside its place, and moves it there.
std::optional<Failure> make_session(const SessionArguments& session, const SessionPlace& place,
                                    const ForeignModel& foreign, const SessionConfig& config,
                                    BegunSession& begun) {
    if (auto failure = fill_session(session, place, foreign, config, begun)) {
        place.abandon();
        return failure;
    }
    if (const auto moved = place.move_there(); !moved.ok()) return Failure{moved.error()};
    return std::nullopt;
}

/// @param points  of the model
void print_begun(const BegunSession& begun, std::size_t points) {
    std::cout << "taken over: " << counted(begun.images, "image") << ", "
              << counted(begun.points, "point") << ", " << counted(begun.pairs, "verified pair")
              << ", in " << counted(begun.clusters, "cluster") << '\n'
              << std::flush;
    if (points > begun.points) {
        std::cerr << "psfm: " << counted(points - begun.points, "point")
                  << " of the model left out: fewer than two images observe "
                  << (points - begun.points == 1 ? "it" : "each") << '\n';
    }
    if (begun.pairs == 0) {
        std::cerr << "psfm: no two images of the model have matches that agree with one geometry: "
                     "each stands alone once the session goes on\n";
    }
    if (!begun.unread.empty()) {
        std::cerr << "psfm: " << begun.unread.front();
        if (begun.unread.size() > 1)
            std::cerr << "; and " << begun.unread.size() - 1 << " more that cannot be read";
        std::cerr << ": taken over without what photographs add\n";
    }
    if (!begun.unlike.empty()) {
        const bool is_one = begun.unlike.size() == 1;
        std::cerr << "psfm: " << counted(begun.unlike.size(), "photograph") << " ("
                  << begun.unlike.front() << (is_one ? "" : ", …") << ") hardly "
                  << (is_one ? "shows" : "show") << " what the model has of "
                  << (is_one ? "it: is it the one" : "them: are they those")
                  << " that the model was made from?\n";
    }
    if (begun.without_descriptors.empty()) return;
    std::cerr << "psfm: " << counted(begun.without_descriptors.size(), "image") << " of the model ("
              << begun.without_descriptors.front()
              << (begun.without_descriptors.size() > 1 ? ", …" : "")
              << (begun.without_descriptors.size() > 1 ? ") have" : ") has")
              << " neither photograph nor descriptors: nothing new can be joined to them\n";
}

/// Looks at what the model is to have come from, before anything is made.
Result<void> check_sources(const ForeignModel& foreign, const ModelImportArguments& arguments) {
    ImportedNames images{.whose = "the model's", .names = {}};
    images.names.reserve(foreign.model.images.size());
    for (const ExportedImage& image : foreign.model.images) images.names.push_back(image.name);
    const ColmapDatabase* database = foreign.database;
    if (database != nullptr) {
        for (const auto& checked :
             {check_matches(*database, arguments.database, "leave --colmap-database out"),
              check_same_images(*database, arguments.database, images)}) {
            if (!checked.ok()) return checked.error();
        }
    }
    return check_photographs(foreign.photo_folder, images, /*all_may_lack=*/database != nullptr,
                             "");
}

std::optional<Failure> begin(const SessionArguments& session, const SessionPlace& place,
                             const ModelImportArguments& arguments, SessionConfig config) {
    std::unique_ptr<ColmapDatabase> database;
    if (!arguments.database.empty()) {
        auto opened = ColmapDatabase::open(arguments.database);
        if (!opened.ok()) return Failure{opened.error()};
        database = *std::move(opened);
    }
    const auto foreign = read_model(arguments, database.get());
    if (!foreign.ok()) return Failure{foreign.error()};
    if (auto checked = check_sources(*foreign, arguments); !checked.ok())
        return Failure{checked.error()};
    remember_model(foreign->model, config);
    config.keep_world = true;
    config.order.clear();  // of what comes after
    const ThreadBudget budget(session.threads);
    BegunSession begun;
    if (auto failure = make_session(session, place, *foreign, config, begun)) return failure;
    print_begun(begun, foreign->model.points.size());
    return std::nullopt;
}

/// A session that is there goes on as it began: with a model that it was made from.
Result<void> check_session(const std::string& session, const ModelImportArguments& arguments) {
    // A folder of other things is told of as `run` does.
    if (const auto state = inspect_session_folder(session); !state.ok()) return state.error();
    const auto reader = open_session_reader(session, StoreOptions{});
    if (!reader.ok()) return reader.error();
    const auto settings = (*reader)->settings();
    if (!settings.ok()) return settings.error();
    const auto config = decode_config(settings->settings_json);
    // Expected: what a later program wrote is refused where the session is opened to go on
    if (config.ok() && config->image_ids.empty()) {
        return Error{ErrorCode::kInvalidArgument,
                     session +
                         " did not begin with a COLMAP model, and takes none in later: "
                         "choose another session folder"};
    }
    const auto model = read_one_model(arguments.model);
    if (!model.ok()) return model.error();
    std::vector<std::uint32_t> ids;
    for (const ExportedImage& image : model->model.images) ids.push_back(image.id);
    // Expected: as above
    if (config.ok() && ids != config->image_ids) {
        return Error{ErrorCode::kInvalidArgument,
                     session + " did not begin with the model in " + arguments.model +
                         ", which has other images: choose another session folder"};
    }
    std::error_code ignored;
    if (!fs::is_directory(arguments.images, ignored)) {
        return Error{ErrorCode::kNotFound,
                     arguments.images + ": there is no such folder of photographs"};
    }
    std::cerr << "psfm: " << session << " has its model already; " << arguments.model
              << " is not read again\n";
    return {};
}

/// Whether the folder has a photograph that the session has not looked at.
Result<bool> has_new_photographs(const std::string& session, const fs::path& folder) {
    const auto reader = open_session_reader(session, StoreOptions{});
    if (!reader.ok()) return reader.error();
    const auto known = known_names(**reader);
    if (!known.ok()) return known.error();
    const auto listing = list_photos(folder);
    if (!listing.ok()) return false;  // Expected: a folder that is gone has none
    for (const PhotoFile& photo : listing->photos) {
        if (!known->contains(photo.name)) return true;
    }
    return false;
}

}  // namespace

int import_model(const CLI::App& command, const SessionArguments& session,
                 const ModelImportArguments& arguments) {
    if (arguments.images.empty()) {
        std::cerr << "psfm: --colmap-model needs --images DIR, the folder of its photographs\n";
        return kUsageError;
    }
    const auto names = [&]() -> Result<std::vector<std::string>> {
        auto listing = list_photos(arguments.images);
        if (!listing.ok()) return listing.error();
        std::vector<std::string> all;
        for (const PhotoFile& photo : listing->photos) all.push_back(photo.name);
        return all;
    };
    auto config = config_from(session, names);
    if (!config.ok()) return report_error(config.error(), ErrorOrigin::kOtherInput);
    const auto place = SessionPlace::find(session.session);
    if (!place.ok()) return report_error(place.error());
    if (!place->is_taken()) {
        if (const auto failure = begin(session, *place, arguments, *config))
            return report_error(failure->error, failure->origin);
    } else if (const auto checked = check_session(session.session, arguments); !checked.ok()) {
        return report_error(checked.error(), ErrorOrigin::kOtherInput);
    }
    const auto more = has_new_photographs(session.session, arguments.images);
    if (!more.ok()) return report_error(more.error());
    if (*more) return start_session(command, session, arguments.images, *std::move(config), false);
    std::cout << "no photograph of " << arguments.images
              << " is new; take the model out with: " << command_line("export", session.session)
              << " --format colmap --output MODEL\n";
    return 0;
}

}  // namespace psfm
