// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/masks_beside_photos.h"

#include <algorithm>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <set>
#include <unordered_set>
#include <utility>

#include "stages/features/photographs/photo_listing.h"
#include "stages/features/photographs/photo_mask.h"
#include "stages/features/photographs/text.h"
#include "stages/features/photographs/unread_files.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMaskEnding = "_mask";

std::string base_of(const std::string& name) {
    const std::size_t slash = name.rfind('/');
    return slash == name.npos ? name : name.substr(slash + 1);
}
std::string without_extension(const std::string& base) {
    return base.substr(0, base.size() - extension_of(base).size());
}

/// The part of a name up to its folder of masks; nothing when it lies in none.
std::optional<std::string> masks_folder_of(const std::string& name) {
    std::size_t begin = 0;
    for (std::size_t slash = name.find('/'); slash != name.npos; slash = name.find('/', begin)) {
        std::string part = name.substr(begin, slash - begin);
        std::ranges::transform(part, part.begin(), [](char c) {
            return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        });
        if (part == "mask" || part == "masks") return name.substr(0, slash);
        begin = slash + 1;
    }
    return std::nullopt;
}

bool is_inside(const fs::path& file, const fs::path& folder) {
    const std::string inner = fs::absolute(file).lexically_normal().generic_string();
    std::string outer = fs::absolute(folder).lexically_normal().generic_string();
    if (!outer.ends_with('/')) outer += '/';
    return inner.starts_with(outer);
}

/// The folder that a photograph's name is relative to.
fs::path root_of(const PhotoFile& photo) {
    fs::path root = photo.path;
    for ([[maybe_unused]] const fs::path& part : fs::path(photo.name)) root = root.parent_path();
    return root;
}

/// Hardly a pixel is anything between.
bool is_black_and_white(const fs::path& file) {
    constexpr double kMostBetween = 0.05;  // Guard: edges, and what compression
                                           // adds; of photographs, most is between
    try {
        const cv::Mat grey = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
        if (grey.empty()) return false;
        const cv::Mat between = (grey > 16) & (grey < 239);
        return cv::countNonZero(between) <= kMostBetween * static_cast<double>(grey.total());
    } catch (const cv::Exception&) {
        return false;
    }
}

/// Names of photographs, to find those that a mask could belong to.
class PhotoNames {
  public:
    explicit PhotoNames(const std::vector<PhotoFile>& photos) {
        for (const PhotoFile& photo : photos) {
            if (masks_folder_of(photo.name)) continue;
            names_.insert(photo.name);
            stems_.insert(without_extension(photo.name));
        }
        for (const std::string& name : names_) {
            if (has_beside(name)) continue;  // a mask itself
            bases_.insert(base_of(name));
            base_stems_.insert(without_extension(base_of(name)));
        }
    }

    /// a.jpg.png or a_mask.png beside a.jpg
    bool has_beside(const std::string& name) const {
        const std::string stem = without_extension(name);
        if (stem != name && names_.contains(stem)) return true;
        return stem.ends_with(kMaskEnding) &&
               stems_.contains(stem.substr(0, stem.size() - kMaskEnding.size()));
    }
    /// Any of the names of masks, wherever the photograph lies.
    bool has_anywhere(const std::string& base) const {
        const std::string stem = without_extension(base);
        if (bases_.contains(stem) || base_stems_.contains(stem)) return true;
        return stem.ends_with(kMaskEnding) &&
               base_stems_.contains(stem.substr(0, stem.size() - kMaskEnding.size()));
    }
    bool is_photo_name(const std::string& base) const { return bases_.contains(base); }

  private:
    std::unordered_set<std::string> names_, stems_, bases_, base_stems_;
};

}  // namespace

std::vector<PhotoFile> set_masks_aside(std::vector<PhotoFile>& photos, const fs::path& given) {
    std::vector<PhotoFile> aside;
    const auto take_out = [&](const auto& is_mask) {
        // std::stable_partition: clang 14, which the fuzzers are built with, has no other.
        const auto first = std::stable_partition(
            photos.begin(), photos.end(), [&](const PhotoFile& photo) { return !is_mask(photo); });
        std::move(first, photos.end(), std::back_inserter(aside));
        photos.erase(first, photos.end());
    };
    if (!given.empty()) {
        // Where masks lie beside their photographs, only their names tell.
        take_out([&](const PhotoFile& photo) {
            return is_inside(photo.path, given) && is_inside(given, root_of(photo));
        });
    }
    const PhotoNames names(photos);
    std::set<std::string> mask_folders;
    std::set<std::string> decided;  // folders whose first doubtful picture was looked at
    for (const PhotoFile& photo : photos) {
        const auto folder = masks_folder_of(photo.name);
        if (!folder || mask_folders.contains(*folder)) continue;
        const std::string base = base_of(photo.name);
        if (!names.has_anywhere(base)) continue;
        const bool is_doubtful = names.is_photo_name(base);
        if (is_doubtful && !decided.insert(*folder).second) continue;
        if (!is_doubtful || is_black_and_white(photo.path)) mask_folders.insert(*folder);
    }
    take_out([&](const PhotoFile& photo) {
        const auto folder = masks_folder_of(photo.name);
        return (folder && mask_folders.contains(*folder)) || names.has_beside(photo.name);
    });
    return aside;
}

Result<MaskUse> match_masks(const fs::path& masks, const std::vector<PhotoFile>& photos) {
    std::error_code unknown;
    if (!fs::is_directory(masks, unknown)) {
        return Error{ErrorCode::kNotFound, "--masks " + printable(masks.native()) +
                                               ": there is no such folder; check the path"};
    }
    MaskUse use;
    std::set<fs::path> used;
    for (const PhotoFile& photo : photos) {
        const auto mask = find_mask(masks, photo);
        if (!mask) continue;
        ++use.masked;
        used.insert(mask->lexically_normal());
    }
    std::set<fs::path> photo_paths;  // masks may lie beside the photographs
    for (const PhotoFile& photo : photos) {
        // Of images whose files are gone only the names are known.
        if (!photo.path.empty()) photo_paths.insert(fs::absolute(photo.path).lexically_normal());
    }
    const auto files = list_photos(masks);
    if (!files.ok()) return use;  // Expected: no picture in it
    for (const PhotoFile& file : files->photos) {
        const fs::path path = file.path.lexically_normal();
        if (!used.contains(path) && !photo_paths.contains(fs::absolute(path)))
            use.unused.push_back(file.name);
    }
    return use;
}

}  // namespace psfm
