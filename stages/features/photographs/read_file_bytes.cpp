// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/read_file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>

#include "stages/features/photographs/text.h"

namespace psfm {
namespace {

/// Closes the descriptor at the end of the scope.
class Descriptor {
  public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }

  private:
    int fd_;
};

std::string remedy_of(int error_number) {
    switch (error_number) {
        case EACCES:
        case EPERM:
            return "; give yourself permission to read it (chmod u+r, and u+x of its folders)";
        case ENOENT:
        case ELOOP:
            return "; check the path, or where the link leads";
        default:
            return "; copy the file again, or check the disk";
    }
}

/// @param what  "cannot be opened", …
Error refused_by_system(const PhotoFile& photo, const std::string& what, int error_number) {
    return {ErrorCode::kIo, printable(photo.name) + ": " + what + " (" +
                                std::system_category().message(error_number) + ")" +
                                remedy_of(error_number)};
}

}  // namespace

Error unreadable(const PhotoFile& photo, const std::string& reason) {
    return {ErrorCode::kUnreadable, printable(photo.name) + ": " + reason};
}

Result<std::vector<std::uint8_t>> read_file_bytes(const PhotoFile& photo, std::uint64_t max_bytes) {
    // O_NONBLOCK: opening a pipe must not wait for its writer.
    const Descriptor file(::open(photo.path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    if (file.get() < 0) return refused_by_system(photo, "cannot be opened", errno);
    struct stat status {};
    if (::fstat(file.get(), &status) != 0) return refused_by_system(photo, "cannot be read", errno);
    if (S_ISDIR(status.st_mode))
        return unreadable(photo, "is a folder, not a photograph; name the files in it");
    if (!S_ISREG(status.st_mode)) {
        return unreadable(photo,
                          "is a pipe, socket or device, not a photograph; give an ordinary file");
    }

    // Guard: some files (in /proc, on network disks) are longer than they say: read until the end.
    constexpr std::size_t kStep = std::size_t{1} << 20U;
    const std::string too_long =
        "is longer than " + std::to_string(max_bytes >> 20U) + " MiB; reduce it";
    if (status.st_size > 0 && static_cast<std::uint64_t>(status.st_size) > max_bytes) {
        return unreadable(photo, too_long);
    }
    std::vector<std::uint8_t> bytes(
        std::max<std::size_t>(static_cast<std::size_t>(status.st_size) + 1, 4096));
    std::size_t used = 0;
    while (true) {
        if (used == bytes.size()) bytes.resize(bytes.size() + kStep);
        const ssize_t count = ::read(file.get(), bytes.data() + used, bytes.size() - used);
        if (count == 0) break;
        if (count < 0) {
            if (errno == EINTR) continue;
            return refused_by_system(photo, "cannot be read", errno);
        }
        used += static_cast<std::size_t>(count);
        if (used > max_bytes) return unreadable(photo, too_long);
    }
    bytes.resize(used);
    if (bytes.empty()) return unreadable(photo, "is empty (0 bytes); copy the file again");
    return bytes;
}

Result<std::uint64_t> content_hash_of(const PhotoFile& photo, std::uint64_t max_bytes) {
    const auto bytes = read_file_bytes(photo, max_bytes);
    if (!bytes.ok()) return bytes.error();
    return std::uint64_t{XXH64(bytes->data(), bytes->size(), 0)};
}

}  // namespace psfm
