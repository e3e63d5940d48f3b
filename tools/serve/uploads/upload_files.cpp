// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/uploads/upload_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <span>

#include "stages/features/photographs/photo_container.h"
#include "tools/serve/uploads/sha256.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

std::string_view extension_of(PhotoFormat format, std::span<const std::uint8_t> bytes) {
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
            return is_avif(bytes) ? "avif" : "heic";
        case PhotoFormat::kJpeg2000:
            return "jp2";
        case PhotoFormat::kPnm:
            return "ppm";
    }
    return "jpg";
}

}  // namespace

bool sync_folder(const fs::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return false;
    const bool done = ::fsync(descriptor) == 0;
    ::close(descriptor);
    return done;
}

fs::path thumbnail_file(const fs::path& session, const std::string& name) {
    return session / "thumbnails" / (sha256_hex(name) + ".jpg");
}

bool append_line(const fs::path& file, const std::string& line, bool durably) {
    constexpr mode_t kOwnerOnly = 0600;  // Format: a mode of Unix
    const int descriptor =
        ::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, kOwnerOnly);
    if (descriptor < 0) return false;
    const off_t before = ::lseek(descriptor, 0, SEEK_END);
    const bool done =
        ::write(descriptor, line.data(), line.size()) == static_cast<ssize_t>(line.size()) &&
        (!durably || ::fsync(descriptor) == 0);
    if (!done && ::ftruncate(descriptor, before) != 0) {
        // A line without its end is passed over when the log is read.
    }
    ::close(descriptor);
    return done;
}

std::optional<PhotoContent> read_content(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return std::nullopt;
    PhotoContent content;
    Sha256 hash;
    std::string chunk(std::size_t{1} << 18U, '\0');
    while (stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) ||
           stream.gcount() > 0) {
        const std::string_view bytes(chunk.data(), static_cast<std::size_t>(stream.gcount()));
        if (content.bytes == 0) {
            const std::span beginning(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                      bytes.size());
            if (const auto format = identify_format(beginning))
                content.extension = extension_of(*format, beginning);
        }
        hash.add(bytes);
        content.bytes += bytes.size();
    }
    content.sha256 = hash.hex();
    return content;
}

}  // namespace psfm
