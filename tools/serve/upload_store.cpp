// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/upload_store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "stages/features/photographs/photo_container.h"
#include "tools/serve/sha256.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

HttpResponse wait_problem(unsigned seconds, const std::string& why) {
    HttpResponse response = problem(429, why);
    response.headers.emplace_back("Retry-After", std::to_string(seconds));
    return response;
}

HttpResponse offset_answer(unsigned status, std::uint64_t offset) {
    HttpResponse response;
    response.status = status;
    response.headers = {{"Upload-Offset", std::to_string(offset)}, {"Cache-Control", "no-store"}};
    return response;
}

bool sync_folder(const fs::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return false;
    const bool done = ::fsync(descriptor) == 0;
    ::close(descriptor);
    return done;
}

/// Appended and on the disk, or the file is as long as it was.
bool append_durably(const fs::path& file, const std::string& line) {
    constexpr mode_t kOwnerOnly = 0600;  // Format: a mode of Unix
    const int descriptor =
        ::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, kOwnerOnly);
    if (descriptor < 0) return false;
    const off_t before = ::lseek(descriptor, 0, SEEK_END);
    const bool done =
        ::write(descriptor, line.data(), line.size()) == static_cast<ssize_t>(line.size()) &&
        ::fsync(descriptor) == 0;
    if (!done && ::ftruncate(descriptor, before) != 0) {
        // A line without its end is passed over when the log is read.
    }
    ::close(descriptor);
    return done;
}

std::string_view extension_of(PhotoFormat format) {
    switch (format) {
        case PhotoFormat::kJpeg:
            return "jpg";
        case PhotoFormat::kPng:
            return "png";
        case PhotoFormat::kTiff:
            return "tif";
        case PhotoFormat::kWebp:
            return "webp";
        case PhotoFormat::kBmp:
            return "bmp";
        case PhotoFormat::kHeif:
            return "heic";
        case PhotoFormat::kJpeg2000:
            return "jp2";
        case PhotoFormat::kPnm:
            return "ppm";
    }
    return "jpg";
}

struct Content {
    std::string sha256;
    std::optional<PhotoFormat> format;
    std::uint64_t bytes = 0;
};

std::optional<Content> read_content(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return std::nullopt;
    Content content;
    Sha256 hash;
    std::string chunk(std::size_t{1} << 18U, '\0');
    while (stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) ||
           stream.gcount() > 0) {
        const std::string_view bytes(chunk.data(), static_cast<std::size_t>(stream.gcount()));
        if (content.bytes == 0) {
            content.format = identify_format(
                {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
        }
        hash.add(bytes);
        content.bytes += bytes.size();
    }
    content.sha256 = hash.hex();
    return content;
}

}  // namespace

/// Bytes of one request, onto the end of the part file.
class UploadSink final : public BodySink {
  public:
    UploadSink(UploadStore& store, UploadStore::Offer offer)
        : store_(&store), offer_(std::move(offer)), at_(offer_.offset) {}
    ~UploadSink() override { end(); }
    UploadSink(const UploadSink&) = delete;
    UploadSink& operator=(const UploadSink&) = delete;

    std::optional<HttpResponse> write(std::string_view bytes) override {
        if (at_ + bytes.size() > offer_.length)
            return stop(problem(413, "more bytes came than Upload-Length says"));
        if (descriptor_ < 0) {
            const fs::path part = store_->part_of(offer_.user, offer_.sha256);
            std::error_code ignored;
            fs::create_directories(part.parent_path(), ignored);
            constexpr mode_t kOwnerOnly = 0600;  // Format: a mode of Unix
            descriptor_ = ::open(part.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, kOwnerOnly);
            if (descriptor_ < 0) return stop(disk_problem(errno));
        }
        while (!bytes.empty()) {
            const ssize_t count =
                ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(at_));
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) return stop(disk_problem(errno));
            at_ += static_cast<std::uint64_t>(count);
            bytes.remove_prefix(static_cast<std::size_t>(count));
        }
        return std::nullopt;
    }

    HttpResponse finish() override {
        HttpResponse response;
        if (at_ < offer_.length) {
            response = offset_answer(204, at_);
        } else if (descriptor_ >= 0 && ::fsync(descriptor_) != 0) {
            response = disk_problem(errno);
        } else {
            response = store_->complete(offer_);
        }
        end();
        return response;
    }

    void give_up() override { end(); }

  private:
    static HttpResponse disk_problem(int number) {
        if (number == ENOSPC || number == EDQUOT || number == EFBIG)
            return problem(507, "the server's disk is full; what was sent so far is kept");
        return problem(503, "the server cannot write at the moment; try again");
    }
    HttpResponse stop(HttpResponse response) {
        end();
        return response;
    }
    void end() {
        if (descriptor_ >= 0) ::close(descriptor_);
        descriptor_ = -1;
        if (!ended_) store_->release(offer_.sha256);
        ended_ = true;
    }

    UploadStore* store_;
    UploadStore::Offer offer_;
    std::uint64_t at_;
    int descriptor_ = -1;
    bool ended_ = false;
};

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
    if (const auto done = store->read_log(); !done.ok()) return done.error();
    store->unfinished_ = UnfinishedUploads::found_in(store->folder_);
    return store;
}

Result<void> UploadStore::read_log() {
    std::ifstream stream(session_ / "uploads.log");
    std::string line;
    while (std::getline(stream, line)) {
        const auto object = nlohmann::json::parse(line, nullptr, false);
        if (!object.is_object()) continue;  // broken off by a crash: it was never acknowledged
        try {
            Upload upload{
                object.at("sha256").get<std::string>(), object.at("user").get<std::uint32_t>(),
                object.at("name").get<std::string>(), object.at("file").get<std::string>(),
                object.at("time").get<std::int64_t>()};
            if (!is_sha256(upload.sha256) || by_sha256_.contains(upload.sha256)) continue;
            std::error_code error;
            const auto bytes = fs::file_size(folder_ / upload.file, error);
            if (error) continue;  // removed since
            bytes_of_user_[upload.user] += bytes;
            by_sha256_[upload.sha256] = by_file_[upload.file] = uploads_.size();
            uploads_.push_back(std::move(upload));
        } catch (const nlohmann::json::exception&) {
            continue;
        }
    }
    return {};
}

fs::path UploadStore::part_of(std::uint32_t user, const std::string& sha256) const {
    return folder_ / std::to_string(user) / (sha256 + ".part");
}

UploadStore::Progress UploadStore::progress(std::uint32_t user, const std::string& sha256) const {
    const std::lock_guard lock(mutex_);
    std::error_code error;
    if (const auto known = by_sha256_.find(sha256); known != by_sha256_.end()) {
        const auto bytes = fs::file_size(folder_ / uploads_[known->second].file, error);
        return {error ? 0 : bytes, true};
    }
    const auto bytes = fs::file_size(part_of(user, sha256), error);
    return {error ? 0 : bytes, false};
}

UploadStore::Admission UploadStore::admit(const Offer& offer) {
    const auto refuse = [](HttpResponse response) {
        return Admission{std::move(response), nullptr};
    };
    if (!is_sha256(offer.sha256))
        return refuse(problem(404, "a photograph is called by its SHA-256, in small letters"));
    if (offer.length == 0 || offer.length > limits_.most_bytes) {
        return refuse(problem(
            413, "a photograph has 1 to " + std::to_string(limits_.most_bytes) + " bytes here"));
    }
    const Progress here = progress(offer.user, offer.sha256);
    if (here.complete) return refuse(offset_answer(200, here.offset));
    const std::lock_guard lock(mutex_);
    if (open_.contains(offer.sha256))
        return refuse(problem(423, "this photograph is being sent at the moment"));
    if (offer.offset > here.offset) {
        HttpResponse response = problem(409, "the bytes before these are not here");
        response.headers.emplace_back("Upload-Offset", std::to_string(here.offset));
        return refuse(std::move(response));
    }
    if (queue_.size() >= limits_.queue)
        return refuse(wait_problem(10, "many photographs wait to be looked at"));
    if (open_.size() >= limits_.at_once)
        return refuse(wait_problem(1, "many photographs are being sent at the moment"));
    if (bytes_of_user_[offer.user] + unfinished_.bytes_beside(offer.user, offer.sha256) +
            offer.length >
        limits_.quota_bytes)
        return refuse(problem(507, "you have sent as much as one user may here"));
    struct statvfs disk {};
    if (::statvfs(folder_.c_str(), &disk) == 0 &&
        static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize <
            limits_.free_bytes + offer.length) {
        return refuse(problem(507, "the server's disk is nearly full"));
    }
    open_.insert(offer.sha256);
    unfinished_.begin(offer.user, offer.sha256, offer.length);
    return {std::nullopt, std::make_unique<UploadSink>(*this, offer)};
}

void UploadStore::release(const std::string& sha256) {
    const std::lock_guard lock(mutex_);
    open_.erase(sha256);
}

void UploadStore::give_up(const Offer& offer) {
    std::error_code ignored;
    fs::remove(part_of(offer.user, offer.sha256), ignored);
    const std::lock_guard lock(mutex_);
    unfinished_.end(offer.user, offer.sha256);
}

HttpResponse UploadStore::complete(const Offer& offer) {
    const fs::path part = part_of(offer.user, offer.sha256);
    const auto content = read_content(part);
    if (!content) return problem(503, "the server cannot read what it has written; try again");
    std::error_code ignored;
    if (content->sha256 != offer.sha256 || content->bytes != offer.length) {
        give_up(offer);
        return problem(422, "the bytes that came have another SHA-256; send them again");
    }
    if (!content->format) {
        give_up(offer);
        return problem(415,
                       "this is no photograph: JPEG, PNG, TIFF, WebP, BMP, HEIC, JPEG 2000 "
                       "and PNM are read");
    }
    Upload upload;
    upload.sha256 = offer.sha256;
    upload.user = offer.user;
    upload.title = offer.title;
    upload.file = std::to_string(offer.user) + '/' + offer.sha256 + '.' +
                  std::string(extension_of(*content->format));
    upload.time = std::time(nullptr);
    const fs::path file = folder_ / upload.file;
    std::error_code error;
    fs::rename(part, file, error);
    if (error || !sync_folder(file.parent_path()) || !sync_folder(folder_))
        return problem(503, "the server cannot write at the moment; try again");
    const ordered_json line{{"sha256", upload.sha256},
                            {"user", upload.user},
                            {"name", upload.title},
                            {"file", upload.file},
                            {"time", upload.time}};
    const std::string text =
        "\n" + line.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
    const std::lock_guard lock(mutex_);
    if (!append_durably(session_ / "uploads.log", text)) {
        fs::rename(file, part, ignored);  // not acknowledged: it comes again
        return problem(507, "the server's disk is full; what was sent so far is kept");
    }
    bytes_of_user_[upload.user] += content->bytes;
    unfinished_.end(upload.user, upload.sha256);
    by_sha256_[upload.sha256] = by_file_[upload.file] = uploads_.size();
    queue_.push_back({file, upload.file});
    uploads_.push_back(std::move(upload));
    HttpResponse response = offset_answer(201, content->bytes);
    response.headers.emplace_back("Location", "/api/v1/photographs/" + offer.sha256);
    return response;
}

std::vector<Upload> UploadStore::uploads() const {
    const std::lock_guard lock(mutex_);
    return uploads_;
}

std::optional<Upload> UploadStore::find(const std::string& sha256) const {
    const std::lock_guard lock(mutex_);
    const auto known = by_sha256_.find(sha256);
    return known == by_sha256_.end() ? std::nullopt : std::optional(uploads_[known->second]);
}

std::optional<Upload> UploadStore::find_file(const std::string& file) const {
    const std::lock_guard lock(mutex_);
    const auto known = by_file_.find(file);
    return known == by_file_.end() ? std::nullopt : std::optional(uploads_[known->second]);
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
    for (const Upload& upload : uploads_) {
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
