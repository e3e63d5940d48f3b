// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/watch_folder.h"

#include "stages/features/photo_listing.h"

namespace psfm {

PhotoSource::Next WatchFolder::next(PhotoFile& photo) {
    if (ready_.empty() && std::chrono::steady_clock::now() >= next_look_) {
        look();
        next_look_ = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    }
    if (ready_.empty()) return Next::kLater;
    photo = ready_.front();
    ready_.pop_front();
    return Next::kPhoto;
}

void WatchFolder::look() {
    const auto listing = list_photos(folder_);
    if (!listing.ok())
        return;  // still empty, or gone for the moment: a watched folder may come back
    // Of files that are gone again nothing is kept: this runs for weeks.
    std::map<std::string, std::uintmax_t> size_at_this_look;
    for (const PhotoFile& photo : listing->photos) {
        if (handed_on_.contains(photo.name)) continue;
        std::error_code error;
        const std::uintmax_t size = std::filesystem::file_size(photo.path, error);
        if (error) continue;
        const auto known = size_at_last_look_.find(photo.name);
        if (known != size_at_last_look_.end() && known->second == size) {
            handed_on_.insert(photo.name);
            ready_.push_back(photo);
        } else {
            size_at_this_look.emplace(photo.name, size);
        }
    }
    size_at_last_look_ = std::move(size_at_this_look);
}

}  // namespace psfm
