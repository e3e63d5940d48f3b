// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/upload_sink.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace psfm {
namespace {

namespace fs = std::filesystem;

HttpResponse disk_problem(int number) {
    if (number == ENOSPC || number == EDQUOT || number == EFBIG)
        return problem(507, "the server's disk is full; what was sent so far is kept");
    return problem(503, "the server cannot write at the moment; try again");
}

}  // namespace

HttpResponse offset_answer(unsigned status, std::uint64_t offset) {
    HttpResponse response;
    response.status = status;
    response.headers = {{"Upload-Offset", std::to_string(offset)}, {"Cache-Control", "no-store"}};
    return response;
}

UploadSink::UploadSink(UploadStore& store, UploadStore::Offer offer, fs::path part)
    : store_(&store), offer_(std::move(offer)), part_(std::move(part)), at_(offer_.offset) {}

std::optional<HttpResponse> UploadSink::write(std::string_view bytes) {
    if (at_ + bytes.size() > *offer_.length)
        return stop(problem(413, "more bytes came than Upload-Length says"));
    if (descriptor_ < 0) {
        std::error_code ignored;
        fs::create_directories(part_.parent_path(), ignored);
        constexpr mode_t kOwnerOnly = 0600;  // Format: a mode of Unix
        descriptor_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, kOwnerOnly);
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

HttpResponse UploadSink::finish() {
    HttpResponse response;
    if (at_ < *offer_.length) {
        response = offset_answer(204, at_);
    } else if (descriptor_ >= 0 && ::fsync(descriptor_) != 0) {
        response = disk_problem(errno);
    } else {
        response = store_->complete(offer_, part_);
    }
    end();
    return response;
}

HttpResponse UploadSink::stop(HttpResponse response) {
    end();
    return response;
}

void UploadSink::end() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
    if (!ended_) store_->release(offer_, part_);
    ended_ = true;
}

}  // namespace psfm
