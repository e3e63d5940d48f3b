// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Photographs that are taken back by who sent them.
#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>
#include <utility>

#include "tools/serve/sha256.h"
#include "tools/serve/upload_store.h"
#include "tools/serve/uploads/upload_files.h"

namespace psfm {

namespace fs = std::filesystem;

HttpResponse UploadStore::remove(std::uint32_t user, const std::string& sha256, bool whoever_sent) {
    HttpResponse gone;
    gone.status = 204;
    const std::lock_guard lock(mutex_);
    if (open_.contains(sha256))
        return problem(423, "this photograph is being sent at the moment; try again after that");
    if (unfinished_.length_of(user, sha256)) {
        std::error_code ignored;
        fs::remove(unfinished_.part_of(user, sha256), ignored);
        unfinished_.end(user, sha256);
        return gone;
    }
    const bool is_own = sent_by_.contains({user, sha256});
    if (!by_sha256_.contains(sha256) || (!is_own && !whoever_sent))
        return problem(404, "you have sent no such photograph");
    nlohmann::ordered_json line{{"removed", sha256}, {"user", user}, {"time", std::time(nullptr)}};
    if (whoever_sent) line["of_all"] = true;
    if (!append_line(session_ / "uploads.log", "\n" + line.dump() + "\n", true))
        return problem(507, "the server's disk is full; the photograph is still here");
    if (const auto file = take_back(user, sha256, whoever_sent)) {
        std::error_code error;  // Expected: what is not there need not be removed
        fs::remove(folder_ / *file, error);
        fs::remove(thumbnail_file(session_, *file), error);
        std::erase_if(queue_, [&](const PhotoFile& photo) { return photo.name == *file; });
        removed_.push_back(*file);
    }
    return gone;
}

std::optional<std::string> UploadStore::take_back(std::uint32_t user, const std::string& sha256,
                                                  bool whoever_sent) {
    const auto known = by_sha256_.find(sha256);
    if (known == by_sha256_.end()) return std::nullopt;
    const auto is_claim = [&](const auto& sent) {
        return sent.second == sha256 && (whoever_sent || sent.first == user);
    };
    std::erase_if(sent_by_, is_claim);
    std::erase_if(repeats_, [&](const Upload& repeat) {
        return is_claim(std::pair(repeat.user, repeat.sha256));
    });
    Upload& upload = uploads_[known->second];
    if (!whoever_sent && upload.user != user) return std::nullopt;
    std::error_code error;  // Expected: somebody removed the file; it counts no more
    const auto bytes = fs::file_size(folder_ / upload.file, error);
    if (!error) bytes_of_user_[upload.user] -= std::min(bytes_of_user_[upload.user], bytes);
    // It stays where it is as long as somebody else has sent it, too.
    const auto other = std::ranges::find(repeats_, sha256, &Upload::sha256);
    if (other != repeats_.end()) {
        upload.user = other->user;
        upload.title = other->title;
        if (!error) bytes_of_user_[upload.user] += bytes;
        repeats_.erase(other);
        return std::nullopt;
    }
    std::string file = upload.file;
    uploads_.erase(uploads_.begin() + static_cast<std::ptrdiff_t>(known->second));
    by_sha256_.clear();
    by_file_.clear();
    for (std::size_t i = 0; i < uploads_.size(); ++i)
        by_sha256_[uploads_[i].sha256] = by_file_[uploads_[i].file] = i;
    return file;
}

bool UploadStore::has_removed() const {
    const std::lock_guard lock(mutex_);
    return !removed_.empty();
}

std::vector<std::string> UploadStore::take_removed() {
    const std::lock_guard lock(mutex_);
    return std::exchange(removed_, {});
}

}  // namespace psfm
