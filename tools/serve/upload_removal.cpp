// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Photographs that are taken back by who sent them.
#include <ctime>
#include <utility>

#include "tools/serve/upload_store.h"
#include "tools/serve/uploads/upload_files.h"

namespace psfm {

HttpResponse UploadStore::remove(std::uint32_t user, const std::string& sha256, bool whoever_sent) {
    HttpResponse gone;
    gone.status = 204;
    std::error_code error;  // Expected, below: what is not there need not be removed
    const std::lock_guard lock(mutex_);
    if (open_.contains(sha256))
        return problem(423, "this photograph is being sent at the moment; try again after that");
    const bool had_begun = drop_unfinished(user, sha256);
    const bool is_there = book_.find(sha256) != nullptr;
    if (!is_there || (!whoever_sent && !book_.has_sent(user, sha256)))
        return had_begun ? gone : problem(404, "you have sent no such photograph");
    const std::string line =
        SentBook::line_of_removal(user, sha256, whoever_sent, std::time(nullptr));
    if (!append_line(session_ / "uploads.log", line, true))
        return problem(507, "the server's disk is full; the photograph is still here");
    if (const auto file = book_.take_back(user, sha256, whoever_sent)) {
        std::filesystem::remove(folder_ / *file, error);
        std::filesystem::remove(thumbnail_file(session_, *file), error);
        std::erase_if(queue_, [&](const PhotoFile& photo) { return photo.name == *file; });
        removed_.insert(*file);
    }
    return gone;
}

bool UploadStore::drop_unfinished(std::uint32_t user, const std::string& sha256) {
    if (!unfinished_.length_of(user, sha256)) return false;
    std::error_code error;  // Expected: it has begun and nothing has come yet
    std::filesystem::remove(unfinished_.part_of(user, sha256), error);
    unfinished_.end(user, sha256);
    return true;
}

bool UploadStore::has_removed() const {
    const std::lock_guard lock(mutex_);
    return !removed_.empty();
}

std::vector<std::string> UploadStore::take_removed() {
    const std::lock_guard lock(mutex_);
    const auto removed = std::exchange(removed_, {});
    return {removed.begin(), removed.end()};
}

}  // namespace psfm
