// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/files/output_file.h"

#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <system_error>

namespace psfm {

Error file_error(const std::filesystem::path& path, int error_number) {
    const std::string reason = std::generic_category().message(error_number);
    if (error_number == ENOSPC || error_number == EDQUOT) {
        return {ErrorCode::kNoSpace, path.string() + " cannot be written: " + reason +
                                         "; free some space or choose another output folder"};
    }
    if (error_number == EEXIST || error_number == ENOTDIR || error_number == EISDIR) {
        return {ErrorCode::kInvalidArgument,
                path.string() + " cannot be written: something of that name is there (" + reason +
                    "); remove it, or choose another output folder"};
    }
    return {ErrorCode::kIo, path.string() + " cannot be written: " + reason +
                                "; check the folder's permissions or choose another output folder"};
}

OutputFile::OutputFile(const std::filesystem::path& path)
    : path_(path), file_(std::fopen(path.c_str(), "wb")) {
    if (!file_) failure_ = errno;
}

void OutputFile::bytes(const void* data, std::size_t count) {
    if (failure_ != 0 || count == 0) return;
    if (std::fwrite(data, 1, count, file_.get()) != count) failure_ = errno;
}

void OutputFile::number(double value) {
    std::array<char, 32> digits{};
    const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), value);
    text({digits.data(), static_cast<std::size_t>(written.ptr - digits.data())});
}

void OutputFile::number(std::uint64_t value) {
    std::array<char, 32> digits{};
    const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), value);
    text({digits.data(), static_cast<std::size_t>(written.ptr - digits.data())});
}

Result<void> OutputFile::close() {
    if (failure_ == 0 && std::fflush(file_.get()) != 0) failure_ = errno;
    // A device like /dev/full or a pipe cannot be synced, and need not be.
    if (failure_ == 0 && fsync(fileno(file_.get())) != 0 && errno != EINVAL && errno != EROFS) {
        failure_ = errno;
    }
    std::FILE* file = file_.release();
    if (file != nullptr && std::fclose(file) != 0 && failure_ == 0) failure_ = errno;
    if (failure_ != 0) return file_error(path_, failure_);
    return {};
}

}  // namespace psfm
