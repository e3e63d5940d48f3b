// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/dataset_pictures.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <sstream>

#include "scheduler/session/photo_folders.h"
#include "stages/features/photographs/photo_mask.h"
#include "stages/features/photographs/read_file_bytes.h"
#include "storage/exchange/files/link_on_the_way.h"
#include "storage/exchange/models/dataset_names.h"
#include "storage/exchange/models/export_models.h"
#include "tools/commands/console/count_line.h"

namespace psfm {
namespace {

/// Memory of the photographs under way: a task waits until there is some left, or nobody has any.
class MemoryBudget {
  public:
    class Share {
      public:
        Share(MemoryBudget& budget, std::uint64_t bytes) : budget_(&budget), bytes_(bytes) {
            std::unique_lock lock(budget.mutex_);
            budget.changed_.wait(
                lock, [&] { return budget.taken_ == 0 || budget.taken_ + bytes <= kBytes; });
            budget.taken_ += bytes;
        }
        Share(const Share&) = delete;
        Share& operator=(const Share&) = delete;
        ~Share() {
            {
                const std::lock_guard lock(budget_->mutex_);
                budget_->taken_ -= bytes_;
            }
            budget_->changed_.notify_all();
        }

      private:
        MemoryBudget* budget_;
        std::uint64_t bytes_;
    };

  private:
    // Guard: of pictures that are in memory at a time.
    static constexpr std::uint64_t kBytes = std::uint64_t{600} << 20U;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::uint64_t taken_ = 0;
};

std::string settings_text(const DatasetPictureOptions& options) {
    std::ostringstream text;
    text << "blank " << options.view.blank_pixels << " max " << options.view.max_size
         << " multiple " << options.view.multiple << " centred " << options.view.centred
         << " quality " << options.picture.jpeg_quality << " reduced";
    for (const std::uint32_t factor : options.picture.reductions) text << ' ' << factor;
    if (options.picture.masks) text << " masks";
    return text.str();
}

/// What a word of settings_text() has after it.
template <typename Value>
bool take(std::istream& text, const char* word, Value& value) {
    std::string found;
    return text >> found && found == word && text >> value;
}

/// What a picture's mask is made of, so that it is made again when that changes; 0: nothing.
std::uint64_t mask_hash(const PictureOptions& options, const PhotoFile& photo) {
    if (!options.masks || options.mask_folder.empty()) return 0;
    const auto file = find_mask(options.mask_folder, photo);
    if (!file) return 0;
    const auto bytes =
        read_file_bytes({*file, photo.name}, std::uint64_t{options.read.max_file_mib} << 20U);
    return bytes ? XXH64(bytes->data(), bytes->size(), 0) : 0;
}

/// The view that pictures of a camera are made with: the one that they were made with before, as
/// long as that is as good.
Result<std::uint32_t> view_for(const Camera& camera, std::uint8_t quarter_turns,
                               const DatasetPictureOptions& options,
                               std::vector<UndistortedView>& views) {
    for (std::uint32_t v = 0; v < views.size(); ++v) {
        if (largest_difference_px(views[v], camera, quarter_turns) <= options.unchanged_px)
            return v;
    }
    auto view = make_undistorted_view(camera, quarter_turns, options.view);
    if (!view.ok()) return view.error();
    views.push_back(*std::move(view));
    return static_cast<std::uint32_t>(views.size() - 1);
}

/// images, images_2, …, masks, masks_2, …
std::vector<std::string> picture_folders(const PictureOptions& options) {
    std::vector<std::string> folders;
    const auto add = [&](const std::string& folder) {
        folders.push_back(folder);
        for (const std::uint32_t factor : options.reductions)
            folders.push_back(folder + "_" + std::to_string(factor));
    };
    add("images");
    if (options.masks) add("masks");
    return folders;
}

bool all_there(const std::filesystem::path& place, const std::string& name, std::uint64_t bytes,
               const PictureOptions& options) {
    const auto places = picture_places(name, options);
    for (std::size_t k = 0; k < places.size(); ++k) {
        if (link_on_the_way(place, place / places[k])) return false;  // an earlier export's
        std::error_code failure;
        const auto size = std::filesystem::file_size(place / places[k], failure);
        if (failure || (k == 0 && size != bytes)) return false;
    }
    return true;
}

/// Views that no picture was made with go, and the others' numbers with them.
void drop_unused_views(PicturePlan& plan) {
    std::vector<std::uint32_t> number(plan.record.views.size(), 0);
    for (const auto& image : plan.images) {
        if (image) number[image->view] = 1;
    }
    std::vector<UndistortedView> used;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == 0) continue;
        number[v] = static_cast<std::uint32_t>(used.size());
        used.push_back(plan.record.views[v]);
    }
    plan.record.views = std::move(used);
    for (auto& image : plan.images) {
        if (image) image->view = number[image->view];
    }
    for (auto& [name, picture] : plan.record.pictures) picture.view = number[picture.view];
}

}  // namespace

std::optional<DatasetPictureOptions> settings_of(const DatasetRecord& record) {
    DatasetPictureOptions options;
    std::istringstream text(record.settings);
    std::string word;
    const bool is_whole = take(text, "blank", options.view.blank_pixels) &&
                          take(text, "max", options.view.max_size) &&
                          take(text, "multiple", options.view.multiple) &&
                          take(text, "centred", options.view.centred) &&
                          take(text, "quality", options.picture.jpeg_quality) && text >> word;
    if (!is_whole) return std::nullopt;
    for (std::uint32_t factor = 0; text >> factor;) options.picture.reductions.push_back(factor);
    text.clear();
    options.picture.masks = text >> word && word == "masks";
    return options;
}

std::vector<std::filesystem::path> picture_places(const std::string& name,
                                                  const PictureOptions& options) {
    std::vector<std::filesystem::path> places;
    const std::size_t pictures = 1 + options.reductions.size();
    const auto folders = picture_folders(options);
    places.reserve(folders.size());
    for (std::size_t k = 0; k < folders.size(); ++k)
        places.push_back(std::filesystem::path(folders[k]) /
                         (k < pictures ? name : mask_name(name)));
    return places;
}

PhotoFile photo_in(std::span<const std::filesystem::path> folders, const std::string& name) {
    const auto found = find_photo(folders, name);
    return {found.value_or(folders.back() / name), name};
}

Result<PicturePlan> plan_pictures(const ExportedModel& model, std::span<const Image> images,
                                  std::span<const std::string> names,
                                  std::span<const std::filesystem::path> folders,
                                  const std::filesystem::path& place,
                                  const DatasetPictureOptions& options) {
    DatasetRecord before = read_dataset_record(place / kDatasetRecordName);
    PicturePlan plan;
    plan.record.settings = settings_text(options);
    const bool same_settings = before.settings == plan.record.settings;
    if (same_settings) plan.record.views = before.views;
    for (std::size_t i = 0; i < model.images.size(); ++i) {
        const ExportedImage& image = model.images[i];
        const Image* photo = find_session_image(images, image.id);
        if (photo == nullptr) {
            plan.images.emplace_back();
            continue;
        }
        const std::uint8_t orientation = photo->metadata.orientation;
        const auto view = view_for(model.find_camera(image.camera_id)->camera,
                                   upright_quarter_turns(orientation), options, plan.record.views);
        if (!view.ok()) return view.error();
        const std::string& stem = names[static_cast<std::size_t>(photo - images.data())];
        const std::string name = stem + picture_extension(photo->name, options.picture.format);
        plan.images.push_back(DatasetImage{*view, name});
        DatasetRecord::Picture wanted{*view, photo->metadata.content_hash, orientation, 0,
                                      mask_hash(options.picture, photo_in(folders, photo->name))};
        const auto made = before.pictures.find(name);
        if (same_settings && made != before.pictures.end()) {
            wanted.bytes = made->second.bytes;
            if (made->second == wanted && all_there(place, name, wanted.bytes, options.picture)) {
                plan.record.pictures.emplace(name, wanted);
                continue;
            }
        }
        plan.record.pictures.emplace(name, wanted);
        plan.tasks.push_back({i, photo});
    }
    drop_unused_views(plan);
    return plan;
}

Result<std::vector<std::string>> make_pictures(PicturePlan& plan,
                                               std::span<const std::filesystem::path> folders,
                                               const std::filesystem::path& place,
                                               const PictureOptions& options, StagedFiles& files,
                                               const std::atomic<bool>& stop) {
    MemoryBudget budget;
    CountLine line(" photographs undistorted", plan.tasks.size());
    std::mutex mutex;
    std::vector<std::optional<std::string>> left_out(plan.tasks.size());
    std::optional<Error> failure;
    const auto make = [&](std::size_t t) {
        const PictureTask& task = plan.tasks[t];
        const DatasetImage& image = *plan.images[task.image];
        const UndistortedView& view = plan.record.views[image.view];
        // Photograph, its bytes, its grey copy, picture and encoder; the mask and its picture.
        const auto pixels = std::uint64_t{view.photo.width} * view.photo.height;
        const MemoryBudget::Share share(budget, (options.masks ? 12 : 9) * pixels);
        const auto made =
            undistort_photo(photo_in(folders, task.photo->name), task.photo->metadata.content_hash,
                            task.photo->metadata.orientation, view, options);
        Result<void> written;
        const auto places = picture_places(image.name, options);
        for (std::size_t k = 0; made.ok() && written.ok() && k < places.size(); ++k) {
            const std::size_t pictures = made->bytes.size();
            const auto& bytes = k < pictures ? made->bytes[k] : made->masks[k - pictures];
            written = files.write(place / places[k],
                                  [&](OutputFile& file) { file.raw(bytes.data(), bytes.size()); });
        }
        const std::lock_guard lock(mutex);
        line.advance();
        if (!made.ok()) left_out[t] = made.error().message;
        if (!written.ok() && !failure) failure = written.error();
        if (made.ok()) plan.record.pictures.at(image.name).bytes = made->bytes.front().size();
    };
    // One at a time: each is long, and their sizes differ.
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, plan.tasks.size(), 1),
        [&](const auto& range) {
            for (std::size_t t = range.begin(); t < range.end(); ++t) {
                if (stop) return;
                {
                    const std::lock_guard lock(mutex);
                    if (failure) return;
                }
                make(t);
            }
        },
        tbb::simple_partitioner());
    if (failure) return *failure;
    if (stop) {
        return Error{ErrorCode::kCancelled,
                     "stopped on request; " + place.string() + " is as it was before"};
    }
    std::vector<std::string> reasons;
    for (std::size_t t = 0; t < plan.tasks.size(); ++t) {
        if (!left_out[t]) continue;
        reasons.push_back(*left_out[t]);
        auto& image = plan.images[plan.tasks[t].image];
        plan.record.pictures.erase(image->name);
        image.reset();
    }
    return reasons;
}

}  // namespace psfm
