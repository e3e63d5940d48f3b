// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/export_dataset.h"

#include <algorithm>
#include <iostream>
#include <numeric>

#include "graph/wording.h"
#include "scheduler/front_end/foreign_features.h"
#include "scheduler/session/file_stamp.h"
#include "scheduler/session/photo_folders.h"
#include "scheduler/session/session_config.h"
#include "storage/exchange/models/dataset_names.h"
#include "storage/exchange/models/export_models.h"
#include "storage/exchange/models/previous_export.h"
#include "storage/exchange/models/write_dataset.h"
#include "storage/exchange/models/write_models.h"
#include "storage/session/session_store.h"
#include "tools/commands/console/interrupts.h"
#include "tools/commands/console/mask_report.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/thread_budget.h"
#include "tools/commands/exchange/dataset_pictures.h"
#include "tools/commands/exchange/dataset_request.h"
#include "tools/commands/exchange/geo_files.h"
#include "tools/commands/exchange/geo_report.h"
#include "tools/commands/exchange/output_folder.h"

namespace psfm {
namespace {

/// What the session has to say.
struct DatasetContents {
    std::filesystem::path session;
    Scene scene;
    std::vector<Image> images;  ///< content hash 0: came without its photograph
    std::vector<bool> removed;  ///< beside each
    std::vector<std::filesystem::path> photo_folders;
    std::filesystem::path mask_folder;  ///< of `psfm run --masks`; empty: none
    std::vector<ExportedModel> models;
};

Result<DatasetContents> read_session(const SessionReader& session, const std::string& place,
                                     std::optional<std::uint32_t> after_image) {
    DatasetContents contents;
    contents.session = place;
    auto scene = after_image ? session.scene_after(*after_image) : session.scene();
    if (!scene.ok()) return scene.error();
    contents.scene = *std::move(scene);
    auto images = session.images();
    if (!images.ok()) return images.error();
    contents.images = *std::move(images);
    const auto sources = session.image_sources();
    if (!sources.ok()) return sources.error();
    for (const Image& image : contents.images)
        contents.removed.push_back((*sources)[index_of(image.id)].removed);
    const auto settings = session.settings();
    if (!settings.ok()) return settings.error();
    auto folders = photo_folders(session, place);
    if (!folders.ok()) return folders.error();
    contents.photo_folders = *std::move(folders);
    const auto config = decode_config(settings->settings_json);
    if (config.ok()) {
        contents.mask_folder = config->masks;
    } else {
        std::cerr << "psfm: " << config.error().message
                  << "; masks given to `psfm run` are not known: give --mask-folder\n";
    }
    if (config.ok() && (!config->image_ids.empty() || !config->colmap_database.empty())) {
        for (Image& image : contents.images) {
            const auto keypoints = session.keypoints(image.id);
            if (!keypoints.ok()) return keypoints.error();
            if (image.metadata.content_hash == hash_without_photograph(image.name, **keypoints))
                image.metadata.content_hash = 0;
        }
    }
    auto models = export_models(
        contents.scene, contents.images, [&](ImageId image) { return session.keypoints(image); },
        FeatureUse::kObserved);
    if (!models.ok()) return models.error();
    contents.models = *std::move(models);
    return contents;
}

DatasetPictureOptions picture_options(const DatasetArguments& arguments) {
    DatasetPictureOptions options;
    options.view.blank_pixels = arguments.blank_pixels;
    options.view.max_size = arguments.max_size;
    options.view.centred = !arguments.off_centre;
    options.picture.jpeg_quality = arguments.jpeg_quality;
    options.picture.reductions = arguments.reductions;
    options.picture.masks = arguments.masks || !arguments.mask_folder.empty();
    options.picture.mask_folder = arguments.mask_folder;
    if (arguments.image_format == "jpg") options.picture.format = PictureFormat::kJpeg;
    if (arguments.image_format == "png") options.picture.format = PictureFormat::kPng;
    for (const std::uint32_t factor : arguments.reductions)
        options.view.multiple = std::lcm(options.view.multiple, factor);
    return options;
}

bool is_picture_folder(const std::string& name) {
    return name.starts_with("images") || name.starts_with("masks");
}

/// One export into one folder.
class DatasetExport {
  public:
    DatasetExport(const DatasetContents& contents, const DatasetArguments& arguments,
                  std::filesystem::path output, PreviousExport previous)
        : contents_(contents),
          arguments_(arguments),
          options_(picture_options(arguments)),
          output_(std::move(output)),
          previous_(std::move(previous)),
          files_(output_) {
        std::vector<std::string> names;
        names.reserve(contents.images.size());
        for (const Image& image : contents.images) names.push_back(image.name);
        names_ = dataset_names(names, contents.removed);
        if (options_.picture.mask_folder.empty())
            options_.picture.mask_folder = contents.mask_folder;
        photos_.assign(arguments.images.begin(), arguments.images.end());
        // Photographs that came since an earlier export named its folders lie in the session's.
        if (photos_.empty() || arguments.as_before) {
            photos_.insert(photos_.end(), contents.photo_folders.begin(),
                           contents.photo_folders.end());
        }
    }

    std::optional<Failure> run() {
        if (auto told = tell_of_given_masks(); !told.ok()) return of_output(told.error());
        for (std::size_t n = 0; n < contents_.models.size(); ++n) {
            if (arguments_.part && *arguments_.part != n) continue;
            if (auto failure = stage_part(n)) return failure;
        }
        if (parts_.empty()) {
            return of_output({ErrorCode::kNotFound,
                              left_out_.empty() ? "there is nothing to write" : left_out_.front()});
        }
        if (auto failure = stage_geo()) return failure;
        return commit();
    }

    void print() const {
        std::size_t shown = 0;
        constexpr std::size_t kShown = 10;  // Format: photographs in a message
        for (const std::string& reason : left_out_) {
            if (++shown <= kShown) std::cerr << "left out " << reason << '\n';
        }
        if (left_out_.size() > kShown) {
            std::cerr << "left out " << counted(left_out_.size() - kShown, "more photograph")
                      << '\n';
        }
        for (const std::string& remark : {trouble_, hint_}) {
            if (!remark.empty()) std::cerr << "psfm: " << remark << '\n';
        }
        for (const std::string& line : summary_) std::cout << line << '\n';
        std::cout << std::flush;
    }

  private:
    std::filesystem::path place_of(std::size_t part) const {
        return arguments_.part ? output_ : output_ / std::to_string(part);
    }

    Result<void> tell_of_given_masks() const {
        if (arguments_.mask_folder.empty()) return {};
        std::vector<PhotoFile> photos;
        photos.reserve(contents_.images.size());
        for (const Image& image : contents_.images) photos.push_back(photo_in(photos_, image.name));
        return tell_of_masks(arguments_.mask_folder, photos);
    }

    std::optional<Failure> stage_part(std::size_t n) {
        const ExportedModel& model = contents_.models[n];
        const std::filesystem::path place = place_of(n);
        auto plan = plan_pictures(model, contents_.images, names_, photos_, place, options_);
        if (!plan.ok()) return of_output(plan.error());
        for (const auto& image : plan->images) {
            if (!image) continue;
            for (const auto& path : picture_places(image->name, options_.picture)) {
                if (auto ours = previous_.claim(place / path); !ours.ok())
                    return of_output(ours.error());
            }
        }
        std::vector<std::filesystem::path> others = dataset_model_files(place);
        others.push_back(place / kDatasetRecordName);
        for (const auto& path : others) {
            if (auto ours = previous_.claim(path); !ours.ok()) return of_output(ours.error());
        }
        for (const auto& folder : dataset_folders(place)) {
            if (auto ours = previous_.claim_folder(folder); !ours.ok())
                return of_output(ours.error());
        }
        const std::size_t wanted = plan->tasks.size();
        const auto planned = plan->images;
        auto left_out =
            make_pictures(*plan, photos_, place, options_.picture, files_, catch_interrupts());
        if (!left_out.ok()) return of_output(left_out.error());
        const auto pictures = static_cast<std::size_t>(std::ranges::count_if(
            plan->images, [](const auto& image) { return image.has_value(); }));
        if (pictures == 0) {
            if (contents_.models.size() == 1 || arguments_.part)
                return of_output(no_photographs(place, *left_out));
            left_out_.push_back("all of " + place.string() + ": " +
                                no_photographs(place, *left_out).message);
            previous_.give_up(place);
            if (previous_.wrote(place / kDatasetRecordName)) previous_.keep(place);
            return std::nullopt;
        }
        parts_.push_back({n, &model, float_origin(model)});
        const ExportedModel undistorted =
            dataset_model(model, plan->record.views, plan->images, parts_.back().origin);
        if (auto staged = stage_dataset(undistorted, place, options_.picture.masks, files_);
            !staged.ok())
            return of_output(staged.error());
        plan->record.asked = request_of(arguments_);
        records_.emplace_back(place / kDatasetRecordName, dataset_record_text(plan->record));
        for (std::size_t i = 0; i < planned.size(); ++i) {
            if (!planned[i] || plan->images[i]) continue;
            for (const auto& path : picture_places(planned[i]->name, options_.picture))
                previous_.give_up(place / path);
        }
        left_out_.insert(left_out_.end(), left_out->begin(), left_out->end());
        summary_.push_back(place.string() + ": " + counted(pictures, "image") + " of " +
                           counted(undistorted.cameras.size(), "camera") + ", " +
                           counted(undistorted.points.size(), "point") +
                           (undistorted.points.empty() ? " (most trainers want some)" : "") + "; " +
                           counted(wanted - left_out->size(), "picture") + " written");
        return std::nullopt;
    }

    Error no_photographs(const std::filesystem::path& place,
                         const std::vector<std::string>& reasons) const {
        if (std::ranges::all_of(photos_, is_gone)) {
            return {ErrorCode::kNotFound,
                    (photos_.size() < 2 && arguments_.images.empty()
                         ? contents_.session.string() + " does not know where its photographs are"
                         : photos_.back().string() + " is not there") +
                        ": name the folder that has the photographs with --images"};
        }
        return {ErrorCode::kNotFound, "no photograph of " + place.string() + " can be used: " +
                                          (reasons.empty() ? "none is known" : reasons.front())};
    }

    std::optional<Failure> stage_geo() {
        const std::span images = contents_.images;
        const auto known =
            images.first(std::min<std::size_t>(contents_.scene.image_count, images.size()));
        const auto reference = world_reference_of(contents_.models, known);
        trouble_ = position_trouble(reference, contents_.models, known);
        if (!tells_location(contents_.session, arguments_.share_location)) {
            hint_ = location_hint(reference, arguments_.share_location);
            return std::nullopt;
        }
        for (const auto& [name, text] : geo_files(reference, parts_, known)) {
            const std::filesystem::path path = output_ / name;
            if (auto ours = previous_.claim(path); !ours.ok()) return of_output(ours.error());
            auto staged =
                files_.write(path, [&, &words = text](OutputFile& file) { file.text(words); });
            if (!staged.ok()) return of_output(staged.error());
        }
        if (reference)
            summary_.push_back((output_ / "geo.txt").string() + ": " + describe(*reference));
        return std::nullopt;
    }

    std::optional<Failure> commit() {
        std::size_t pictures = 0;
        for (const auto& path : previous_.outdated()) {
            if (is_picture_folder(path.parent_path().filename().string())) ++pictures;
        }
        if (pictures > 0) {
            summary_.push_back(output_.string() + ": " + counted(pictures, "picture") +
                               " of an earlier export removed");
        }
        // Records come last: a picture counts as made once all are in their places.
        for (const auto& [path, text] : records_) {
            auto staged =
                files_.write(path, [&, &words = text](OutputFile& file) { file.text(words); });
            if (!staged.ok()) return of_output(staged.error());
        }
        if (auto done = previous_.settle(files_); !done.ok()) return of_output(done.error());
        return std::nullopt;
    }

    const DatasetContents& contents_;
    const DatasetArguments& arguments_;
    DatasetPictureOptions options_;
    std::filesystem::path output_;
    PreviousExport previous_;
    std::vector<std::filesystem::path> photos_;  ///< folders; the first ones count first
    std::vector<std::string> names_;
    StagedFiles files_;
    std::vector<std::pair<std::filesystem::path, std::string>> records_;
    std::vector<GeoPart> parts_;
    std::vector<std::string> left_out_;
    std::string trouble_;
    std::string hint_;
    std::vector<std::string> summary_;
};

std::optional<Failure> check_parts(const DatasetContents& contents, const std::string& session,
                                   const std::string& output, const DatasetArguments& arguments) {
    if (contents.models.empty()) {
        return of_session({ErrorCode::kNotFound, session + ": the session has no model yet: " +
                                                     counted(contents.scene.image_count, "image") +
                                                     " waiting; `psfm status` says why"});
    }
    if (arguments.part && *arguments.part >= contents.models.size()) {
        return of_output(
            {ErrorCode::kNotFound,
             session + " has " + counted(contents.models.size(), "connected part") +
                 ", numbered from 0: there is no part " + std::to_string(*arguments.part) +
                 (arguments.as_before ? ", which " + output +
                                            " was made of: name another one with `psfm export "
                                            "--format dataset --part`"
                                      : "")});
    }
    return std::nullopt;
}

}  // namespace

int export_dataset(const std::string& session, const std::string& output,
                   std::optional<std::uint32_t> after_image, const DatasetArguments& arguments) {
    const auto reader = open_session_reader(session, StoreOptions{});
    if (!reader.ok()) return report_error(reader.error());
    if (const auto apart = check_apart_from_photographs(output, **reader, session); !apart.ok())
        return report_error(apart.error(), ErrorOrigin::kOtherInput);
    auto contents = read_session(**reader, session, after_image);
    if (!contents.ok()) return report_error(contents.error());
    auto previous = PreviousExport::take(output);
    if (!previous.ok()) return report_error(previous.error(), ErrorOrigin::kOtherInput);
    const ThreadBudget budget(arguments.threads);
    auto asked = with_request_of_before(arguments, output, *previous);
    if (!asked.ok()) return report_error(asked.error(), ErrorOrigin::kOtherInput);
    if (const auto failure = check_parts(*contents, session, output, *asked))
        return report_error(failure->error, failure->origin);
    std::ranges::sort(asked->reductions);
    const auto again = std::ranges::unique(asked->reductions);
    asked->reductions.erase(again.begin(), again.end());
    DatasetExport dataset(*contents, *asked, output, *std::move(previous));
    const auto failure = dataset.run();
    if (failure) return report_error(failure->error, failure->origin);
    dataset.print();
    return 0;
}

}  // namespace psfm
