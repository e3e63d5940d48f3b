// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/front_end/salvage_photographs.h"

#include <algorithm>
#include <array>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "scheduler/session/known_files.h"
#include "scheduler/session/photo_folders.h"
#include "stages/features/feature_options.h"
#include "stages/features/photographs/masks_beside_photos.h"
#include "stages/features/photographs/photo_listing.h"
#include "stages/features/photographs/read_file_bytes.h"
#include "storage/exchange/database/colmap_database.h"
#include "storage/exchange/files/image_name.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

/// Photographs that may be those whose names are lost, each folder's in order of arrival.
class Arrivals {
  public:
    void add(const fs::path& folder, const std::vector<PhotoFile>& photos) {
        folders_.emplace_back(folder, std::deque(photos.begin(), photos.end()));
    }

    /// The next one of the first of these folders that has one; else of any.
    std::optional<PhotoFile> next(std::span<const fs::path> preferred) {
        for (const fs::path& wanted : preferred) {
            for (auto& [folder, photos] : folders_) {
                if (folder == wanted && !photos.empty()) return take(photos);
            }
        }
        for (auto& [folder, photos] : folders_) {
            if (!photos.empty()) return take(photos);
        }
        return std::nullopt;
    }

  private:
    static PhotoFile take(std::deque<PhotoFile>& photos) {
        PhotoFile photo = std::move(photos.front());
        photos.pop_front();
        return photo;
    }

    std::vector<std::pair<fs::path, std::deque<PhotoFile>>> folders_;
};

/// Where a damaged session's photographs are.
class Photographs {
  public:
    Photographs(const IntactImages& intact, const SessionConfig& config, fs::path input,
                const fs::path& session)
        : intact_(&intact),
          config_(&config),
          input_(std::move(input)),
          is_database_(!config.colmap_database.empty()),
          folders_(photo_folders(intact.sources, input_, session)) {}

    /// The folder that the k-th intact image was taken from.
    fs::path folder_of(std::size_t k) const {
        const std::string& folder = intact_->sources[k].file.folder;
        return folder.empty() ? input_ : fs::path(folder);
    }

    /// In the folder that it was taken from; where that has it no more, in another one that has the
    /// same content under its name.
    PhotoFile file_of(std::size_t k) const {
        const Image& image = intact_->images[k];
        if (is_database_) return {input_, image.name};
        const fs::path own_folder = folder_of(k);
        if (auto own = find_photo(std::span(&own_folder, 1), image.name))
            return {*std::move(own), image.name};
        for (const fs::path& folder : folders_) {
            const auto other = find_photo(std::span(&folder, 1), image.name);
            if (other && is_content_of(image, *other)) return {*other, image.name};
        }
        return gone(image.name, own_folder);
    }

    /// @param known  names that the session has
    Arrivals arrivals(const std::set<std::string>& known) const {
        Arrivals arrivals;
        if (is_database_) {
            arrivals.add(input_, unknown_in_database(known));
            return arrivals;
        }
        std::set<fs::path> seen;  // one folder may be named twice, or lie within another
        for (const fs::path& folder : folders_) {
            if (!was_taken_from(folder)) continue;
            auto photos = unknown_in(folder, known);
            if (folder == input_) photos = in_order(std::move(photos), known);
            std::erase_if(photos, [&](const PhotoFile& photo) {
                return !seen.insert(photo.path.lexically_normal()).second;
            });
            arrivals.add(folder, photos);
        }
        return arrivals;
    }

  private:
    /// Whether the session took photographs from this very folder. A folder of which it has images
    /// in folders within alone need not be one: a second card's, `CARD/NAME`, are in that around
    /// the card's, with whatever else is there.
    bool was_taken_from(const fs::path& folder) const {
        if (folder == folders_.front() || folder == input_) return true;
        for (std::size_t k = 0; k < intact_->images.size(); ++k) {
            const bool lies_in_it = intact_->images[k].name.find('/') == std::string::npos;
            if (lies_in_it && folder_of(k) == folder) return true;
        }
        return false;
    }

    static bool is_content_of(const Image& image, const fs::path& file) {
        const auto hash = content_hash_of({file, image.name},
                                          std::uint64_t{ReadPhotoOptions{}.max_file_mib} << 20U);
        // Expected: what cannot be read is none that is known
        return hash.ok() && *hash == image.metadata.content_hash;
    }

    /// To be told by its place. Names that lead out of the folder are no file's.
    static PhotoFile gone(const std::string& name, const fs::path& folder) {
        return {problem_of_name(name) ? folder : folder / name, name};
    }

    std::vector<PhotoFile> unknown_in_database(const std::set<std::string>& known) const {
        std::vector<PhotoFile> photos;
        photos.reserve(config_->order.size());
        for (const std::string& name : config_->order) photos.push_back({input_, name});
        if (photos.empty()) {
            const auto database = ColmapDatabase::open(input_);
            // Expected: a database that is gone has no images; what was extracted is taken over
            if (!database.ok()) return {};
            for (const DatabaseImage& image : (*database)->images())
                photos.push_back({input_, image.name});
        }
        std::erase_if(photos, [&](const PhotoFile& photo) { return known.contains(photo.name); });
        return photos;
    }

    /// What a folder has, by name, and the session has neither by name nor by content.
    std::vector<PhotoFile> unknown_in(const fs::path& folder,
                                      const std::set<std::string>& known) const {
        auto listing = list_photos(folder);
        // Expected: a folder that is gone has no photographs; what was extracted is taken over
        if (!listing.ok()) return {};
        set_masks_aside(listing->photos, config_->masks);
        // By id; those whose records are damaged are nobody's, as if they had been taken out.
        std::vector<Image> images(intact_->count);
        std::vector<ImageSource> sources(intact_->count);
        for (ImageSource& source : sources) source.removed = true;
        for (std::size_t k = 0; k < intact_->images.size(); ++k) {
            const std::uint32_t id = index_of(intact_->images[k].id);
            images[id] = intact_->images[k];
            sources[id] = intact_->sources[k];
        }
        KnownFiles files = compare_with_session(images, sources, listing->photos, folder, input_);
        std::set<std::string> moved;
        for (const SourcedImage& image : files.moved) moved.insert(image.image.name);
        std::erase_if(files.photos, [&](const PhotoFile& photo) {
            return known.contains(photo.name) || moved.contains(photo.name);
        });
        return std::move(files.photos);
    }

    /// As the session's order says, and only those, also where they are gone.
    std::vector<PhotoFile> in_order(std::vector<PhotoFile> photos,
                                    const std::set<std::string>& known) const {
        if (config_->order.empty()) return photos;
        std::map<std::string, PhotoFile> by_name;
        for (PhotoFile& photo : photos) by_name.emplace(photo.listed_as(), photo);
        std::vector<PhotoFile> ordered;
        for (const std::string& name : config_->order) {
            if (const auto found = by_name.find(name); found != by_name.end()) {
                ordered.push_back(found->second);
            } else if (!known.contains(name)) {
                ordered.push_back(gone(name, input_));
            }
        }
        return ordered;
    }

    const IntactImages* intact_;
    const SessionConfig* config_;
    fs::path input_;
    bool is_database_;
    std::vector<fs::path> folders_;
};

std::set<std::string> names_of(const SessionReader& damaged, const IntactImages& intact) {
    std::set<std::string> names;
    for (const Image& image : intact.images) names.insert(image.name);
    // Expected: where these are damaged their photographs are looked at again
    if (const auto rejected = damaged.rejected(); rejected.ok()) {
        for (const RejectedPhoto& photo : *rejected) names.insert(photo.name);
    }
    return names;
}

}  // namespace

std::vector<PhotoFile> photographs_to_salvage(const SessionReader& damaged,
                                              const IntactImages& intact,
                                              const SessionConfig& config, const fs::path& input,
                                              const fs::path& session) {
    const Photographs photographs(intact, config, input, session);
    Arrivals arrivals;
    if (intact.images.size() < intact.count)
        arrivals = photographs.arrivals(names_of(damaged, intact));
    std::vector<PhotoFile> photos;
    std::array<fs::path, 2> neighbours;  // the folders of the images before and after
    std::size_t k = 0;
    for (std::uint32_t id = 0; id < intact.count; ++id) {
        const bool is_left = k < intact.images.size();
        if (is_left && index_of(intact.images[k].id) == id) {
            neighbours[0] = photographs.folder_of(k);
            if (!intact.removed.contains(intact.images[k].id))
                photos.push_back(photographs.file_of(k));
            ++k;
            continue;
        }
        neighbours[1] = is_left ? photographs.folder_of(k) : fs::path();
        if (auto next = arrivals.next(neighbours)) photos.push_back(*std::move(next));
    }
    return photos;
}

Result<void> keep_sources(const IntactImages& intact, const Salvage& salvage,
                          SessionStore& repaired) {
    const auto images = repaired.images();
    if (!images.ok()) return images.error();
    const auto sources = repaired.image_sources();
    if (!sources.ok()) return sources.error();
    std::map<ImageId, const ImageSource*> before;
    for (std::size_t k = 0; k < intact.images.size(); ++k)
        before.emplace(intact.images[k].id, &intact.sources[k]);
    std::vector<SourcedImage> known_better;
    for (const auto& [here, there] : salvage.taken_over) {
        const ImageSource& source = *before.at(there);
        if (source != (*sources)[index_of(here)])
            known_better.push_back({(*images)[index_of(here)], source});
    }
    if (known_better.empty()) return {};
    return repaired.commit_files(known_better);
}

}  // namespace psfm
