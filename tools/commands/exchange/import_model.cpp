// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/import_model.h"

#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>

#include "graph/wording.h"
#include "scheduler/front_end/begin_from_model.h"
#include "stages/features/photographs/photo_listing.h"
#include "storage/exchange/models/read_colmap.h"
#include "tools/commands/console/count_line.h"
#include "tools/commands/console/exit_codes.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/thread_budget.h"
#include "tools/commands/session_runner.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

fs::path absolute(const std::string& path) {
    return fs::absolute(path).lexically_normal();
}

/// A model of poses alone has an empty file of points; without one it is not whole.
Result<void> check_points_are_there(const fs::path& folder) {
    std::error_code ignored;
    for (const char* name : {"points3D.bin", "points3D.txt"}) {
        if (fs::is_regular_file(folder / name, ignored)) return {};
    }
    return Error{ErrorCode::kNotFound,
                 folder.string() + " has no points3D.bin or points3D.txt: copy the whole model"};
}

void tell_of_spare_cameras(const ExportedModel& model) {
    std::set<std::uint32_t> used;
    for (const ExportedImage& image : model.images) used.insert(image.camera_id);
    const std::size_t spare = model.cameras.size() - used.size();
    if (spare == 0) return;
    std::cerr << "psfm: " << counted(spare, "camera") << " of the model "
              << (spare == 1 ? "is" : "are") << " left out: no image has "
              << (spare == 1 ? "it" : "them") << '\n';
}

Result<ForeignModel> read_model(const ModelImportArguments& arguments,
                                const ColmapDatabase* database) {
    const auto folders = find_colmap_models(arguments.model);
    if (!folders.ok()) return folders.error();
    if (folders->size() > 1) {
        return Error{ErrorCode::kInvalidArgument,
                     arguments.model + " has " + counted(folders->size(), "model") +
                         ": name one of them, " + folders->front().string() + " for instance"};
    }
    if (auto checked = check_points_are_there(folders->front()); !checked.ok())
        return checked.error();
    auto model = read_colmap_model(folders->front());
    if (!model.ok()) return model.error();
    for (const ExportedCamera& camera : model->cameras) {
        if (const auto valid = validate(camera.camera); !valid.ok()) {
            return Error{ErrorCode::kDamaged, folders->front().string() + ": camera " +
                                                  std::to_string(camera.id) + ": " +
                                                  valid.error().message};
        }
    }
    if (model->images.size() < 2) {
        return Error{ErrorCode::kTooFewMatches,
                     arguments.model + " places " + counted(model->images.size(), "image") +
                         ": there is nothing to go on with; `psfm run` on the photographs"};
    }
    std::set<std::string> names;
    for (const ExportedImage& image : model->images) {
        if (names.insert(image.name).second) continue;
        return Error{ErrorCode::kDamaged,
                     folders->front().string() + " has two images named " + image.name};
    }
    tell_of_spare_cameras(*model);
    return ForeignModel{*std::move(model), database, absolute(arguments.images)};
}

/// Tells of photographs that the folder has not. @errors kNotFound: all of them
Result<void> check_photographs(const ForeignModel& foreign) {
    std::size_t missing = 0;
    std::string first;
    for (const ExportedImage& image : foreign.model.images) {
        if (fs::is_regular_file(foreign.photo_folder / image.name)) continue;
        if (missing++ == 0) first = image.name;
    }
    if (missing == 0) return {};
    const std::string lacks = foreign.photo_folder.string() + " lacks " + first +
                              (missing > 1 ? " and " + std::to_string(missing - 1) + " more" : "") +
                              " of the model's " + counted(foreign.model.images.size(), "image");
    if (missing == foreign.model.images.size() && foreign.database == nullptr) {
        return Error{ErrorCode::kNotFound, lacks +
                                               ": name the folder that COLMAP had as "
                                               "--image_path"};
    }
    std::cerr << "psfm: " << lacks << '\n';
    return {};
}

constexpr std::string_view kImporting = ".importing-";  // Format: between folder and process

/// Removes what imports into this place have left that were killed.
void remove_abandoned(const fs::path& place) {
    const std::string begins = place.filename().string() + std::string(kImporting);
    std::error_code failure;
    const fs::path folder = place.has_parent_path() ? place.parent_path() : fs::path(".");
    for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end;
         entry.increment(failure)) {
        const std::string name = entry->path().filename().string();
        if (!name.starts_with(begins)) continue;
        pid_t process = 0;
        const char* last = name.data() + name.size();
        const auto read = std::from_chars(name.data() + begins.size(), last, process);
        const bool is_ours = read.ec == std::errc() && read.ptr == last && process > 0;
        std::error_code ignored;
        if (is_ours && kill(process, 0) != 0 && errno == ESRCH)
            fs::remove_all(entry->path(), ignored);
    }
}

/// Makes the session beside its place, and moves it there.
std::optional<Failure> make_session(const SessionArguments& session, const ForeignModel& foreign,
                                    SessionConfig config, BegunSession& begun) {
    const fs::path place = session.session;
    remove_abandoned(place);
    const fs::path beside = place.string() + std::string(kImporting) + std::to_string(getpid());
    std::error_code failure;
    {
        StoreOptions options;
        options.cache_bytes = session.cache_mib << 20U;
        auto store = SessionStore::open(beside, options);
        if (!store.ok()) return Failure{store.error(), ErrorOrigin::kSession};
        auto kept = (*store)->put_settings({foreign.photo_folder.string(), encode_config(config)});
        if (!kept.ok()) return Failure{kept.error(), ErrorOrigin::kSession};
        CountLine line(" images of the model taken over", foreign.model.images.size());
        auto made = begin_from_model(**store, foreign, config, [&] { line.advance(); });
        if (!made.ok()) {
            store->reset();
            fs::remove_all(beside, failure);
            return Failure{made.error()};
        }
        begun = *std::move(made);
        config.repeated_observations = begun.repeated_observations;
        kept = (*store)->put_settings({foreign.photo_folder.string(), encode_config(config)});
        if (!kept.ok()) return Failure{kept.error(), ErrorOrigin::kSession};
    }
    fs::remove(place, failure);  // an empty folder
    fs::rename(beside, place, failure);
    if (!failure) return std::nullopt;
    const std::string reason = failure.message();
    fs::remove_all(beside, failure);
    return Failure{{ErrorCode::kIo, place.string() + " cannot be made: " + reason +
                                        "; choose another session folder"}};
}

void print_begun(const BegunSession& begun) {
    std::cout << "taken over: " << counted(begun.images, "image") << ", " << begun.points
              << " points, " << begun.pairs << " verified pairs, in "
              << counted(begun.clusters, "cluster") << '\n'
              << std::flush;
    if (!begun.unlike.empty()) {
        std::cerr << "psfm: " << counted(begun.unlike.size(), "photograph") << " ("
                  << begun.unlike.front() << (begun.unlike.size() > 1 ? ", …" : "")
                  << ") hardly shows what the model has of it: is it the one that the model was "
                     "made from?\n";
    }
    if (begun.without_descriptors.empty()) return;
    std::cerr << "psfm: " << counted(begun.without_descriptors.size(), "image") << " of the model ("
              << begun.without_descriptors.front()
              << (begun.without_descriptors.size() > 1 ? ", …" : "")
              << ") have neither photograph nor descriptors: nothing new can be joined to them\n";
}

std::optional<Failure> begin(const SessionArguments& session, const ModelImportArguments& arguments,
                             SessionConfig config) {
    std::unique_ptr<ColmapDatabase> database;
    if (!arguments.database.empty()) {
        auto opened = ColmapDatabase::open(arguments.database);
        if (!opened.ok()) return Failure{opened.error()};
        database = *std::move(opened);
    }
    const auto foreign = read_model(arguments, database.get());
    if (!foreign.ok()) return Failure{foreign.error()};
    if (auto checked = check_photographs(*foreign); !checked.ok()) return Failure{checked.error()};
    remember_model(foreign->model, config);
    config.keep_world = true;
    config.order.clear();  // of what comes after
    const ThreadBudget budget(session.threads);
    BegunSession begun;
    if (auto failure = make_session(session, *foreign, config, begun)) return failure;
    print_begun(begun);
    return std::nullopt;
}

bool is_session(const std::string& folder) {
    std::error_code ignored;
    return fs::exists(folder, ignored) && !fs::is_empty(folder, ignored);
}

/// A session that is there goes on as it began: with a model that it was made from.
Result<void> check_session(const std::string& session, const ModelImportArguments& arguments) {
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
    if (!is_session(session.session)) {
        if (const auto failure = begin(session, arguments, *config))
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
