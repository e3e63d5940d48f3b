// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/upload_store.h"

#include <sys/statvfs.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tools/serve/upload_sink.h"
#include "tools/serve/uploads/sent_photographs.h"
#include "tools/serve/uploads/sha256.h"
#include "tools/serve/uploads/upload_files.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

HttpResponse wait_problem(unsigned seconds, const std::string& why) {
    HttpResponse response = problem(429, why);
    response.headers.emplace_back("Retry-After", std::to_string(seconds));
    return response;
}

}  // namespace

UploadStore::UploadStore(fs::path session, const UploadLimits& limits)
    : session_(std::move(session)), folder_(session_ / "photographs"), limits_(limits) {}

Result<std::unique_ptr<UploadStore>> UploadStore::open(const fs::path& session,
                                                       const UploadLimits& limits) {
    std::unique_ptr<UploadStore> store(new UploadStore(session, limits));
    std::error_code error;
    fs::create_directories(store->folder_, error);
    if (error) {
        return Error{ErrorCode::kIo, store->folder_.string() + " cannot be made: " +
                                         error.message() + "; is the disk full?"};
    }
    const auto bytes_of = [&](const std::string& file) -> std::uint64_t {
        std::error_code gone;  // Expected: taken back, or removed by somebody
        const auto bytes = fs::file_size(store->folder_ / file, gone);
        return gone ? 0 : bytes;
    };
    store->book_ = SentBook::read(store->session_ / "uploads.log", bytes_of);
    store->removed_ = store->book_.removed();
    // What somebody else removed may come again.
    for (const Upload& upload : std::vector(store->book_.uploads())) {
        if (upload.bytes == 0) store->book_.take_back(upload.user, upload.sha256, true);
    }
    store->unfinished_ = UnfinishedUploads::found_in(store->folder_);
    return store;
}

UploadStore::Progress UploadStore::progress(std::uint32_t user, const std::string& sha256) const {
    const std::lock_guard lock(mutex_);
    if (book_.has_sent(user, sha256)) {
        const std::uint64_t bytes = book_.find(sha256)->bytes;
        return {bytes, bytes, true};
    }
    return begun(user, sha256);
}

UploadStore::Progress UploadStore::begun(std::uint32_t user, const std::string& sha256) const {
    const auto length = unfinished_.length_of(user, sha256);
    if (!length) return {};
    std::error_code error;  // Expected: it has begun and nothing has come yet
    const auto bytes = fs::file_size(unfinished_.part_of(user, sha256), error);
    // Clients take a photograph with all of its bytes for acknowledged. One that the server was
    // killed over before it had looked at them is asked for the last one again.
    return {error ? 0 : std::min<std::uint64_t>(bytes, *length - 1), *length, false};
}

std::optional<HttpResponse> UploadStore::refuse_place(const Offer& offer,
                                                      const Progress& here) const {
    if (offer.anew) return std::nullopt;
    const auto conflict = [&](const std::string& why) {
        HttpResponse response = problem(409, why);
        response.headers.emplace_back("Upload-Offset", std::to_string(here.offset));
        return response;
    };
    if (offer.offset != here.offset)
        return conflict("the next byte that is wanted is " + std::to_string(here.offset));
    if (here.length != 0 && offer.length && *offer.length != here.length) {
        return conflict("this photograph was announced with " + std::to_string(here.length) +
                        " bytes; PUT begins anew");
    }
    if (here.length == 0 && !offer.length)
        return problem(400, "nothing of it is here yet: Upload-Length is wanted");
    return std::nullopt;
}

std::optional<HttpResponse> UploadStore::refuse_share(const Offer& offer,
                                                      std::uint64_t length) const {
    if (queue_.size() >= limits_.queue)
        return wait_problem(10, "many photographs wait to be looked at");
    if (open_.size() >= limits_.at_once)
        return wait_problem(1, "many photographs are being sent at the moment");
    const auto of_user =
        std::ranges::count_if(open_, [&](const auto& one) { return one.second == offer.user; });
    if (static_cast<std::size_t>(of_user) >= limits_.at_once_of_user)
        return wait_problem(1, "you are sending many photographs at the moment");
    if (book_.bytes_of(offer.user) + unfinished_.bytes_beside(offer.user, offer.sha256) + length >
        limits_.quota_bytes)
        return problem(507, "you have sent as much as one user may here");
    struct statvfs disk {};
    if (::statvfs(folder_.c_str(), &disk) == 0 &&
        static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize < limits_.free_bytes + length) {
        return problem(507, "the server's disk is nearly full");
    }
    return std::nullopt;
}

void UploadStore::remove_abandoned() {
    const std::int64_t now = std::time(nullptr);
    if (now < look_for_abandoned_) return;
    look_for_abandoned_ = now + limits_.abandoned_seconds;
    unfinished_.remove_abandoned([&](const std::string& hash) { return open_.contains(hash); });
}

UploadStore::Admission UploadStore::admit(const Offer& asked) {
    const auto refuse = [](HttpResponse response) {
        return Admission{std::move(response), nullptr, 0};
    };
    Offer offer = asked;
    if (!is_sha256(offer.sha256))
        return refuse(problem(404, "a photograph is called by its SHA-256, in small letters"));
    const std::lock_guard lock(mutex_);
    remove_abandoned();
    if (book_.find(offer.sha256) != nullptr) return refuse(know_again(offer));
    if (open_.contains(offer.sha256))
        return refuse(problem(423, "this photograph is being sent at the moment"));
    const Progress here = begun(offer.user, offer.sha256);
    if (auto refusal = refuse_place(offer, here)) return refuse(*std::move(refusal));
    if (!offer.length) offer.length = here.length;
    if (*offer.length == 0) return refuse(problem(422, "this file is empty; choose another"));
    if (*offer.length > limits_.most_bytes) {
        return refuse(problem(
            413, "a photograph has 1 to " + std::to_string(limits_.most_bytes) + " bytes here"));
    }
    if (auto refusal = refuse_share(offer, *offer.length)) return refuse(*std::move(refusal));
    if (offer.anew && here.length != 0) {
        std::error_code ignored;
        fs::remove(unfinished_.part_of(offer.user, offer.sha256), ignored);
    }
    open_.emplace(offer.sha256, offer.user);
    unfinished_.begin(offer.user, offer.sha256, *offer.length);
    const std::uint64_t most = *offer.length - std::min(*offer.length, offer.offset);
    fs::path part = unfinished_.part_of(offer.user, offer.sha256);
    return {std::nullopt, std::make_unique<UploadSink>(*this, std::move(offer), std::move(part)),
            most};
}

HttpResponse UploadStore::know_again(const Offer& offer) {
    Upload repeat = *book_.find(offer.sha256);
    if (!book_.has_sent(offer.user, offer.sha256)) {
        repeat.user = offer.user;
        repeat.title = offer.title;
        repeat.time = std::time(nullptr);
        // Not waited for: the photograph is on the disk for good, and this is on its server's
        // thread.
        if (!append_line(session_ / "uploads.log", SentBook::line_of(repeat), false))
            return problem(507, "the server's disk is full; the photograph is here");
        book_.add(repeat);
    }
    drop_unfinished(offer.user, offer.sha256);  // somebody else was faster
    return offset_answer(200, repeat.bytes);
}

void UploadStore::release(const Offer& offer, const fs::path& part) {
    std::error_code ignored;
    const std::lock_guard lock(mutex_);
    open_.erase(offer.sha256);
    if (!fs::exists(part, ignored)) unfinished_.end(offer.user, offer.sha256);
}

void UploadStore::give_up(const Offer& offer, const fs::path& part) {
    std::error_code ignored;
    fs::remove(part, ignored);
    const std::lock_guard lock(mutex_);
    unfinished_.end(offer.user, offer.sha256);
}

HttpResponse UploadStore::complete(const Offer& offer, const fs::path& part) {
    const auto content = read_content(part);
    if (!content) return problem(503, "the server cannot read what it has written; try again");
    std::error_code ignored;
    if (content->sha256 != offer.sha256 || content->bytes != *offer.length) {
        give_up(offer, part);
        return problem(422, "the bytes that came have another SHA-256; send them again");
    }
    if (!content->extension) {
        give_up(offer, part);
        return problem(415,
                       "this is no photograph: JPEG, PNG, TIFF, WebP, BMP, HEIC, AVIF, "
                       "JPEG 2000 and PNM are read");
    }
    Upload upload;
    upload.sha256 = offer.sha256;
    upload.user = offer.user;
    upload.title = offer.title;
    upload.file =
        std::to_string(offer.user) + '/' + offer.sha256 + '.' + std::string(*content->extension);
    upload.time = std::time(nullptr);
    const fs::path file = folder_ / upload.file;
    std::error_code error;
    fs::rename(part, file, error);
    if (error || !sync_folder(file.parent_path()) || !sync_folder(folder_))
        return problem(503, "the server cannot write at the moment; try again");
    const std::lock_guard lock(mutex_);
    if (!append_line(session_ / "uploads.log", SentBook::line_of(upload), true)) {
        fs::rename(file, part, ignored);  // not acknowledged: it comes again
        return problem(507, "the server's disk is full; what was sent so far is kept");
    }
    upload.bytes = content->bytes;
    unfinished_.end(upload.user, upload.sha256);
    removed_.erase(upload.file);
    queue_.push_back({file, upload.file});
    book_.add(std::move(upload));
    HttpResponse response = offset_answer(201, content->bytes);
    response.headers.emplace_back("Location", "/api/v1/photographs/" + offer.sha256);
    return response;
}

std::vector<Upload> UploadStore::uploads_of(std::uint32_t user) const {
    const std::lock_guard lock(mutex_);
    return book_.uploads_of(user);
}

std::optional<Upload> UploadStore::find(const std::string& sha256) const {
    const std::lock_guard lock(mutex_);
    const Upload* const upload = book_.find(sha256);
    return upload == nullptr ? std::nullopt : std::optional(*upload);
}

std::optional<PhotographOrigin> UploadStore::origin_of(const std::string& file) const {
    const std::lock_guard lock(mutex_);
    return origin_in(book_, file);
}

std::optional<PhotoFile> UploadStore::take() {
    const std::lock_guard lock(mutex_);
    if (queue_.empty()) return std::nullopt;
    PhotoFile photo = std::move(queue_.front());
    queue_.pop_front();
    return photo;
}

std::size_t UploadStore::waiting() const {
    const std::lock_guard lock(mutex_);
    return queue_.size();
}

void UploadStore::queue_missing(const std::set<std::string>& known_names) {
    const std::lock_guard lock(mutex_);
    queue_.clear();
    for (const Upload& upload : book_.uploads()) {
        if (!known_names.contains(upload.file))
            queue_.push_back({folder_ / upload.file, upload.file});
    }
}

PhotoSource::Next UploadSource::next(PhotoFile& photo) {
    auto next = store_->take();
    if (!next) return Next::kLater;
    photo = *std::move(next);
    return Next::kPhoto;
}

}  // namespace psfm
