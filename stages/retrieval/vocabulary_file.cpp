// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/vocabulary_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

namespace psfm {
namespace {

constexpr std::array<char, 8> kMagic{'p', 's', 'f', 'm', 'V', 'O', 'C', '\0'};
/// Format: of the vocabulary's file; the most cells and words that a damaged one may say.
constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kMaxCells = 1U << 16U;
constexpr std::uint64_t kMaxWords = std::uint64_t{1} << 24U;
constexpr std::size_t kChecksumOffset = 24;
constexpr std::size_t kHeaderBytes = 32;
static_assert(std::endian::native == std::endian::little, "the file is little endian");

Error file_error(ErrorCode code, const std::filesystem::path& file, const std::string& problem) {
    return {code, file.string() + ": " + problem};
}

Error system_error(const std::filesystem::path& file, const char* doing) {
    const ErrorCode code = errno == ENOSPC || errno == EDQUOT ? ErrorCode::kNoSpace
                           : errno == ENOENT                  ? ErrorCode::kNotFound
                                                              : ErrorCode::kIo;
    return file_error(code, file, std::string("cannot ") + doing + ": " + std::strerror(errno));
}

std::uint64_t file_size(std::uint64_t cells, std::uint64_t words) {
    return kHeaderBytes + cells * (Descriptors::kSize + sizeof(std::uint32_t)) +
           words * Descriptors::kSize;
}

template <typename T>
T number_at(const std::vector<std::uint8_t>& bytes, std::size_t offset) {
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof(value));
    return value;
}

template <typename T>
void append_number(std::vector<std::uint8_t>& bytes, T value) {
    const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof(value));
}

std::uint64_t checksum(const std::vector<std::uint8_t>& bytes) {
    XXH64_state_t* state = XXH64_createState();
    XXH64_reset(state, 0);
    XXH64_update(state, bytes.data(), kChecksumOffset);
    XXH64_update(state, bytes.data() + kHeaderBytes, bytes.size() - kHeaderBytes);
    const std::uint64_t hash = XXH64_digest(state);
    XXH64_freeState(state);
    return hash;
}

/// Closes on every way out.
class FileDescriptor {
  public:
    FileDescriptor(const std::filesystem::path& file, int flags)
        : fd_(::open(file.c_str(), flags | O_CLOEXEC, 0666)) {}
    ~FileDescriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    int get() const { return fd_; }

  private:
    int fd_;
};

bool write_all(int fd, const std::vector<std::uint8_t>& bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t written = ::write(fd, bytes.data() + done, bytes.size() - done);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return false;
        done += static_cast<std::size_t>(written);
    }
    return true;
}

/// @return bytes read; fewer than asked for at the end of the file or after an error (errno)
std::size_t read_some(int fd, std::uint8_t* to, std::size_t count) {
    std::size_t done = 0;
    errno = 0;
    while (done < count) {
        const ssize_t got = ::read(fd, to + done, count - done);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        done += static_cast<std::size_t>(got);
    }
    return done;
}

/// The whole file, when its header and its length agree.
Result<std::vector<std::uint8_t>> read_checked(const std::filesystem::path& file) {
    const FileDescriptor input(file, O_RDONLY);
    struct stat status {};
    if (input.get() < 0 || ::fstat(input.get(), &status) != 0) {
        Error error = system_error(file, "open the vocabulary");
        if (error.code == ErrorCode::kNotFound)
            error.message += "; `psfm vocabulary train` makes one";
        return error;
    }
    std::vector<std::uint8_t> bytes(kHeaderBytes);
    if (!S_ISREG(status.st_mode) ||
        read_some(input.get(), bytes.data(), bytes.size()) != bytes.size() ||
        std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0) {
        return file_error(ErrorCode::kUnreadable, file,
                          "not a psfm vocabulary; make one with `psfm vocabulary train`");
    }
    const auto version = number_at<std::uint32_t>(bytes, 8);
    if (version > kVersion) {
        return file_error(ErrorCode::kVersion, file,
                          "vocabulary of version " + std::to_string(version) +
                              "; this psfm reads up to version " + std::to_string(kVersion) +
                              ", please update it");
    }
    const auto cells = number_at<std::uint32_t>(bytes, 12);
    const auto words = number_at<std::uint64_t>(bytes, 16);
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (version == 0 || cells == 0 || cells > kMaxCells || words < cells || words > kMaxWords ||
        file_size(cells, words) != size) {
        return file_error(
            ErrorCode::kDamaged, file,
            "damaged vocabulary (header and length disagree); copy or train it again");
    }
    bytes.resize(size);
    if (read_some(input.get(), bytes.data() + kHeaderBytes, size - kHeaderBytes) !=
        size - kHeaderBytes) {
        return system_error(file, "read the vocabulary");
    }
    return bytes;
}

}  // namespace

Result<void> write_vocabulary(const WordTree& tree, const std::filesystem::path& file) {
    const std::size_t cells = tree.cells.rows();
    const std::size_t words = tree.word_count();
    if (cells == 0 || cells > kMaxCells || words > kMaxWords || cells != tree.words.size()) {
        return file_error(
            ErrorCode::kInvalidArgument, file,
            "a vocabulary has 1 to 65536 cells and up to 16777216 words; this one has " +
                std::to_string(cells) + " and " + std::to_string(words));
    }
    std::vector<std::uint8_t> bytes;
    bytes.reserve(file_size(cells, words));
    bytes.insert(bytes.end(), kMagic.begin(), kMagic.end());
    append_number(bytes, kVersion);
    append_number(bytes, static_cast<std::uint32_t>(cells));
    append_number(bytes, static_cast<std::uint64_t>(words));
    append_number(bytes, std::uint64_t{0});
    bytes.insert(bytes.end(), tree.cells.values.begin(), tree.cells.values.end());
    for (const Descriptors& of_cell : tree.words)
        append_number(bytes, static_cast<std::uint32_t>(of_cell.rows()));
    for (const Descriptors& of_cell : tree.words) {
        bytes.insert(bytes.end(), of_cell.values.begin(), of_cell.values.end());
    }
    const std::uint64_t hash = checksum(bytes);
    std::memcpy(bytes.data() + kChecksumOffset, &hash, sizeof(hash));

    const std::filesystem::path temporary = file.string() + ".part-" + std::to_string(::getpid());
    {
        const FileDescriptor output(temporary, O_WRONLY | O_CREAT | O_TRUNC);
        if (output.get() < 0) return system_error(file, "write the vocabulary");
        if (!write_all(output.get(), bytes) || ::fsync(output.get()) != 0) {
            const Error error = system_error(file, "write the vocabulary");
            ::unlink(temporary.c_str());
            return error;
        }
    }
    if (::rename(temporary.c_str(), file.c_str()) != 0) {
        const Error error = system_error(file, "put the vocabulary in place");
        ::unlink(temporary.c_str());
        return error;
    }
    return {};
}

Result<WordTree> read_vocabulary(const std::filesystem::path& file) {
    const auto bytes = read_checked(file);
    if (!bytes.ok()) return bytes.error();
    if (number_at<std::uint64_t>(*bytes, kChecksumOffset) != checksum(*bytes)) {
        return file_error(ErrorCode::kDamaged, file,
                          "damaged vocabulary (wrong checksum); copy or train it again");
    }
    const std::size_t cells = number_at<std::uint32_t>(*bytes, 12);
    const std::uint64_t words = number_at<std::uint64_t>(*bytes, 16);
    WordTree tree;
    auto at = bytes->begin() + kHeaderBytes;
    const auto take = [&at](std::size_t rows) {
        const auto begin = at;
        at += static_cast<std::ptrdiff_t>(rows * Descriptors::kSize);
        return Descriptors{{begin, at}};
    };
    tree.cells = take(cells);
    std::vector<std::uint32_t> counts(cells);
    std::memcpy(counts.data(), &*at, cells * sizeof(std::uint32_t));
    at += static_cast<std::ptrdiff_t>(cells * sizeof(std::uint32_t));
    const std::uint64_t total = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    if (total != words || std::find(counts.begin(), counts.end(), 0U) != counts.end()) {
        return file_error(ErrorCode::kDamaged, file,
                          "damaged vocabulary (number of words); train it again");
    }
    for (const std::uint32_t count : counts) tree.words.push_back(take(count));
    return tree;
}

}  // namespace psfm
