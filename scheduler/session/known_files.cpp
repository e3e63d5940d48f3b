// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/known_files.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "graph/wording.h"
#include "stages/features/feature_options.h"
#include "stages/features/photographs/read_file_bytes.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

/// One spelling of each path, without asking what links lead to.
fs::path spelled(const fs::path& path) {
    std::error_code error;
    const fs::path absolute = fs::absolute(path, error);
    const fs::path normal = (error ? path : absolute).lexically_normal();
    return normal.has_filename() ? normal : normal.parent_path();  // without a '/' at the end
}

std::optional<std::uint64_t> hash_of(const PhotoFile& photo) {
    const auto hash = content_hash_of(photo, std::uint64_t{ReadPhotoOptions{}.max_file_mib} << 20U);
    // Expected: a file that cannot be read is none that is known; taking it in says why
    return hash.ok() ? std::optional(*hash) : std::nullopt;
}

std::string photographs(std::size_t count, const char* one, const char* many) {
    return std::to_string(count) + (count == 1 ? " photograph " : " photographs ") +
           (count == 1 ? one : many);
}

class Comparison {
  public:
    Comparison(std::span<const Image> images, std::span<const ImageSource> sources,
               std::span<const PhotoFile> photos, const fs::path& folder, const fs::path& previous)
        : images_(images),
          sources_(sources),
          photos_(photos),
          folder_(spelled(folder)),
          previous_(spelled(previous)) {
        for (const Image& image : images) {
            const ImageSource& source = sources[index_of(image.id)];
            if (source.removed) continue;
            by_name_.emplace(image.name, &image);
            by_path_.emplace(path_of(image), &image);
            by_hash_.emplace(image.metadata.content_hash, &image);
            sizes_.insert(source.file.size);
        }
    }

    KnownFiles result() {
        for (std::size_t i = 0; i < photos_.size(); ++i) look_at(i);
        follow_moves();
        KnownFiles known;
        for (std::size_t i = 0; i < photos_.size(); ++i) add(i, known);
        for (const auto& [image, place] : places_) {
            SourcedImage moved{*image, sources_[index_of(image->id)]};
            moved.image.name = final_name(*image);
            moved.source.file = place.file;
            if (moved.image.name != image->name || place.file != file(*image))
                known.moved.push_back(std::move(moved));
        }
        std::ranges::sort(known.moved, {},
                          [](const SourcedImage& moved) { return moved.image.id; });
        tell(known);
        return known;
    }

  private:
    enum class Kind : std::uint8_t {
        kNew,      ///< nothing that the session has
        kAtPlace,  ///< an image's own file, under its name or not
        kContent,  ///< the content of an image, elsewhere than that was
        kChanged,  ///< an image's own file with another content, or the name of one that is gone
        kNameOnly  ///< another photograph under the name of an image that is elsewhere
    };
    struct Look {
        Kind kind = Kind::kNew;
        const Image* image = nullptr;
        ImageFile file;
    };
    /// Where an image is by now.
    struct Place {
        std::string name;
        ImageFile file;
    };

    const ImageFile& file(const Image& image) const { return sources_[index_of(image.id)].file; }

    bool is_as_seen(const Image& image, const FileStamp& stamp) const {
        const ImageFile& seen = file(image);
        return seen.modified_ns != 0 && seen.size == stamp.size &&
               seen.modified_ns == stamp.modified_ns;
    }

    fs::path path_of(const Image& image) const {
        const std::string& known = file(image).folder;
        const fs::path folder = known.empty() ? previous_ : fs::path(known);
        return (folder / image.name).lexically_normal();
    }

    static const Image* find(const auto& map, const auto& key) {
        const auto found = map.find(key);
        return found == map.end() ? nullptr : found->second;
    }

    void look_at(std::size_t i) {
        const PhotoFile& photo = photos_[i];
        Look& look = looks_.emplace_back();
        const auto stamp = stamp_of(photo.path);
        if (!stamp) return;  // gone meanwhile: reading it will tell
        look.file = {folder_.string(), stamp->size, stamp->modified_ns};
        const Image* at_path = find(by_path_, spelled(photo.path));
        if (at_path != nullptr && is_as_seen(*at_path, *stamp)) {
            look.kind = Kind::kAtPlace;
            look.image = at_path;
            return;
        }
        const Image* of_name = find(by_name_, photo.name);
        const bool may_be_known = at_path != nullptr || of_name != nullptr || sizes_.contains(0) ||
                                  sizes_.contains(stamp->size);
        const auto hash = may_be_known ? hash_of(photo) : std::nullopt;
        if (!hash) return;
        if (at_path != nullptr && at_path->metadata.content_hash == *hash) {
            look.kind = Kind::kAtPlace;
            look.image = at_path;
        } else if (const Image* content = find(by_hash_, *hash)) {
            look.kind = Kind::kContent;
            look.image = content;
        } else if (at_path != nullptr) {
            look.kind = Kind::kChanged;
            look.image = at_path;
        } else if (of_name != nullptr) {
            look.kind = is_there(*of_name) ? Kind::kNameOnly : Kind::kChanged;
            look.image = of_name;
        }
    }

    /// Whether an image's file is where it was, with its content. One that cannot be read is taken
    /// for what it was.
    bool is_there(const Image& image) const {
        const fs::path path = path_of(image);
        const auto stamp = stamp_of(path);
        if (!stamp) return !is_gone(path);
        if (is_as_seen(image, *stamp)) return true;
        const auto hash = hash_of({path, image.name});
        return !hash || *hash == image.metadata.content_hash;
    }

    /// Each image's place: its own where it is still there, else the first file with its content.
    void follow_moves() {
        for (std::size_t i = 0; i < photos_.size(); ++i) {
            if (looks_[i].kind == Kind::kAtPlace)
                places_.try_emplace(looks_[i].image, Place{photos_[i].name, looks_[i].file});
        }
        for (std::size_t i = 0; i < photos_.size(); ++i) {
            const Look& look = looks_[i];
            if (look.kind != Kind::kContent || places_.contains(look.image)) continue;
            // The same name in another folder is the whole folder moved, or copied.
            if (photos_[i].name == look.image->name || !is_there(*look.image))
                places_.try_emplace(look.image, Place{photos_[i].name, look.file});
        }
        // Names stay unique: who would take that of an image which keeps it stays as it is.
        for (bool changed = true; changed;) {
            changed = false;
            std::map<std::string, const Image*> names;
            for (const auto& [name, image] : by_name_) {
                if (!places_.contains(image) || places_.at(image).name == image->name)
                    names.emplace(name, image);
            }
            for (const auto& [image, place] : places_) {
                if (place.name == image->name || names.emplace(place.name, image).second) continue;
                // Its own file under another name is no move (a second card's, seen from within).
                if (path_of(*image) != spelled(folder_ / place.name))
                    cramped_.push_back(image->name);
                places_.erase(image);
                changed = true;
                break;
            }
        }
    }

    std::string final_name(const Image& image) const {
        const auto place = places_.find(&image);
        return place == places_.end() ? image.name : place->second.name;
    }

    /// Whether no image, and none of the folder's photographs, has this name.
    bool is_free(const std::string& name) const {
        const auto is_taken = [&](const auto& entry) { return final_name(*entry.second) == name; };
        return std::ranges::none_of(by_name_, is_taken) &&
               std::ranges::none_of(photos_, [&](const PhotoFile& p) { return p.name == name; });
    }

    void add(std::size_t i, KnownFiles& known) {
        PhotoFile photo = photos_[i];
        const Look& look = looks_[i];
        const bool is_known = look.kind == Kind::kAtPlace || look.kind == Kind::kContent;
        if (is_known) {
            const bool is_it =
                look.kind == Kind::kAtPlace ||
                (places_.contains(look.image) && final_name(*look.image) == photo.name);
            photo.name = is_it ? final_name(*look.image) : photo.name;
            // A copy is for the session to reject; under the name of another image it never gets so
            // far.
            if (!is_it && by_name_.contains(photo.name)) return;
        } else if (look.kind == Kind::kChanged) {
            changed_.push_back(photo.name);
            return;
        } else if (look.kind == Kind::kNameOnly) {
            photo.name_in_folder = photo.name;
            photo.name = (folder_.filename() / photo.name).generic_string();
            if (!is_free(photo.name)) {
                changed_.push_back(photo.name_in_folder);
                return;
            }
            own_names_.push_back(photo.name);
        }
        known.photos.push_back(std::move(photo));
    }

    void tell(KnownFiles& known) const {
        std::vector<std::string> renamed;
        for (const auto& [image, source] : known.moved) {
            const std::string& before = images_[index_of(image.id)].name;
            if (before != image.name) renamed.push_back(before + " is now " + image.name);
        }
        if (!renamed.empty()) {
            known.told.push_back(photographs(renamed.size(), "was", "were") +
                                 " moved or renamed, and the session follows: " + some_of(renamed));
        }
        if (!own_names_.empty()) {
            known.told.push_back(
                photographs(own_names_.size(), "has the name of another one",
                            "have the names of others") +
                " in the session, and " + (own_names_.size() == 1 ? "is" : "are") +
                " taken in as " + some_of(own_names_) + "; programs that look for " +
                (own_names_.size() == 1 ? "it by that name" : "them by these names") +
                " want the folder that holds " + folder_.filename().string());
        }
        if (!changed_.empty()) {
            known.told.push_back(
                photographs(changed_.size(), "is", "are") + " not what the session has under " +
                (changed_.size() == 1 ? "that name" : "these names") +
                " (edited, or others), and " + (changed_.size() == 1 ? "is" : "are") +
                " not taken in: " + some_of(changed_) +
                "; give them names of their own, or 'psfm remove' the former ones first");
        }
        if (!cramped_.empty()) {
            known.told.push_back(
                photographs(cramped_.size(), "was", "were") +
                " renamed to names that others of the session have, whose files are "
                "gone: " +
                some_of(cramped_) + "; 'psfm remove' those first");
        }
    }

    std::span<const Image> images_;
    std::span<const ImageSource> sources_;
    std::span<const PhotoFile> photos_;
    fs::path folder_;
    fs::path previous_;
    std::map<std::string, const Image*> by_name_;
    std::map<fs::path, const Image*> by_path_;
    std::map<std::uint64_t, const Image*> by_hash_;
    std::set<std::int64_t> sizes_;
    std::vector<Look> looks_;
    std::map<const Image*, Place> places_;
    std::vector<std::string> own_names_;
    std::vector<std::string> changed_;
    std::vector<std::string> cramped_;
};

}  // namespace

KnownFiles compare_with_session(std::span<const Image> images, std::span<const ImageSource> sources,
                                std::span<const PhotoFile> photos, const fs::path& folder,
                                const fs::path& previous_folder) {
    return Comparison(images, sources, photos, folder, previous_folder).result();
}

std::string folder_of(const PhotoFile& photo) {
    const std::string path = spelled(photo.path).generic_string();
    const std::string end = "/" + photo.name;
    const std::string& own = photo.listed_as();
    if (path.ends_with(end)) return path.substr(0, path.size() - end.size());
    return path.ends_with("/" + own) ? path.substr(0, path.size() - own.size() - 1) : std::string();
}

ImageFile file_of(const PhotoFile& photo, const FileStamp& stamp) {
    ImageFile file{folder_of(photo), stamp.size, stamp.modified_ns};
    return file.folder.empty() ? ImageFile{} : file;
}

}  // namespace psfm
