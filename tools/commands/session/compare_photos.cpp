// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <string>

#include "graph/wording.h"
#include "scheduler/session/known_files.h"
#include "stages/features/photographs/masks_beside_photos.h"
#include "stages/features/photographs/photo_listing.h"
#include "stages/features/photographs/photo_mask.h"
#include "stages/features/photographs/read_file_bytes.h"
#include "stages/features/photographs/small_copies.h"
#include "tools/commands/console/mask_report.h"
#include "tools/commands/console/shell_word.h"
#include "tools/commands/session/session_runner.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

void tell(const std::string& line) {
    std::cerr << "psfm: " << line << '\n';
}

/// Files among the photographs that look like masks, and are not in the folder that was given.
void tell_of_masks_aside(const std::vector<PhotoFile>& aside, const std::string& given) {
    std::map<fs::path, std::size_t> folders;
    for (const PhotoFile& file : aside) {
        const std::string relative = fs::path(file.path).lexically_relative(given).generic_string();
        const bool is_given = !given.empty() && !relative.empty() && !relative.starts_with("..");
        if (!is_given) ++folders[file.path.parent_path()];
    }
    for (const auto& [folder, count] : folders) {
        tell(counted(count, "file") + " in " + folder.string() +
             (count == 1 ? " looks like a mask" : " look like masks") + ", and " +
             (count == 1 ? "is" : "are") + " not taken as photographs; '--masks " +
             shell_word(folder.string()) + "' uses them");
    }
}

/// Images of the session that were taken in without the masks that are there now.
void tell_of_late_masks(const std::string& masks, const std::vector<Image>& images,
                        const std::vector<ImageSource>& sources) {
    std::vector<std::string> late;
    for (const Image& image : images) {
        const ImageSource& source = sources[index_of(image.id)];
        if (source.removed) continue;
        const auto mask = find_mask(masks, {fs::path(), image.name});
        if (!mask) continue;
        const auto hash = content_hash_of({*mask, image.name}, std::uint64_t{1} << 32U);
        // Expected: a mask that cannot be read is told of when a photograph wants it
        if (hash.ok() && *hash != source.mask_hash) late.push_back(image.name);
    }
    if (late.empty()) return;
    tell(counted(late.size(), "photograph") + " of the session " +
         (late.size() == 1 ? "was" : "were") + " taken in without the mask that is there now: " +
         some_of(late) + "; 'psfm remove --again' them, and run");
}

}  // namespace

Result<void> compare_photos(RunRequest& request, const SessionReader& store, bool names_masks) {
    if (!request.config.colmap_database.empty()) return {};
    const auto options = stage_options(request.config);
    if (!options.ok()) return options.error();
    const auto read = store.images();
    if (!read.ok()) return read.error();
    const auto sources = store.image_sources();
    if (!sources.ok()) return sources.error();
    const std::vector<Image>& images = *read;
    const auto settings = store.settings();
    // Expected: a new session has none
    if (!settings.ok() && settings.error().code != ErrorCode::kNotFound) return settings.error();
    const fs::path previous_folder = settings.ok() ? settings->photo_folder : std::string();
    const std::string& masks = request.config.masks;
    // All that the folder has: files may have changed their names among themselves, whatever an
    // order says.
    std::vector<PhotoFile> all;
    // Expected: the input may be a file, or gone; then no file of it has changed its name
    if (const auto listing = list_photos(request.input); listing.ok()) all = listing->photos;
    tell_of_masks_aside(set_masks_aside(all, masks), masks);
    if (!masks.empty()) {
        std::vector<PhotoFile> masked = all;
        for (const Image& image : images) masked.push_back({fs::path(), image.name});
        const auto told = tell_of_masks(masks, masked);
        if (!told.ok() && names_masks) return told;
        if (!told.ok()) tell(told.error().message + "; photographs are taken in without masks");
        if (names_masks) tell_of_late_masks(masks, images, *sources);
    }
    KnownFiles known = compare_with_session(images, *sources, all, request.input, previous_folder);
    for (const std::string& line : known.told) tell(line);
    request.moved = std::move(known.moved);
    std::map<fs::path, PhotoFile> by_path;
    for (PhotoFile& photo : known.photos) by_path.emplace(photo.path, std::move(photo));
    std::vector<PhotoFile> photos;
    for (const PhotoFile& photo : request.photos) {
        if (const auto found = by_path.find(photo.path); found != by_path.end())
            photos.push_back(found->second);
    }
    put_small_copies_last(photos, options->features.small_copies);
    request.photos = std::move(photos);
    return {};
}

}  // namespace psfm
