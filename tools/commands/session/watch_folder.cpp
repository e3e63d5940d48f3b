// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/session/watch_folder.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "stages/features/photographs/masks_beside_photos.h"
#include "stages/features/photographs/photo_listing.h"

namespace psfm {

namespace fs = std::filesystem;

PhotoSource::Next WatchFolder::next(PhotoFile& photo) {
    if (ready_.empty() && std::chrono::steady_clock::now() >= next_look_) {
        look();
        next_look_ = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    }
    while (!ready_.empty()) {
        photo = std::move(ready_.front());
        ready_.pop_front();
        if (stamp_of(photo.path)) return Next::kPhoto;
        handed_on_.erase(photo.name);  // gone while it waited; it may come back
    }
    return Next::kLater;
}

void WatchFolder::look() {
    auto listing = list_photos(folder_);
    if (!listing.ok()) {
        // Still empty, or gone for the moment: what was handed on is still known when it is back.
        std::error_code away;
        const fs::directory_iterator entries(folder_, away);
        tell(away ? std::set{listing.error().message + "; waiting for it"}
                  : std::set<std::string>{});
        if (!away) handed_on_.clear();
        return;
    }
    std::set<std::string> lines;
    for (const RejectedPath& rejected : listing->rejected)
        lines.insert("rejected " + rejected.name + ": " + rejected.reason);
    // Once a kind: the numbers change while files are copied.
    for (const auto& [kind, extensions] : listing->unread) {
        for (const auto& [extension, count] : extensions)
            lines.insert("not taken: files that end with " + extension);
    }
    tell(std::move(lines));
    set_masks_aside((*listing).photos, masks_);

    std::map<std::string, FileStamp> this_look;
    std::map<std::string, FileStamp> still_there;
    for (const PhotoFile& photo : listing->photos) {
        const std::optional<FileStamp> stamp = stamp_of(photo.path);
        if (!stamp) continue;
        const auto known = handed_on_.find(photo.name);
        if (known != handed_on_.end() && known->second == *stamp) {
            still_there.insert(*known);
            continue;
        }
        const auto before = last_look_.find(photo.name);
        if (before != last_look_.end() && before->second == *stamp) {
            still_there.emplace(photo.name, *stamp);
            ready_.push_back(photo);
        } else {
            this_look.emplace(photo.name, *stamp);
        }
    }
    last_look_ = std::move(this_look);
    handed_on_ = std::move(still_there);
}

void WatchFolder::tell(std::set<std::string> lines) {
    for (const std::string& line : lines) {
        if (!told_.contains(line)) tell_(line);
    }
    told_ = std::move(lines);
}

}  // namespace psfm
