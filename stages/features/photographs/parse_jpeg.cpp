// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "stages/features/photographs/byte_view.h"
#include "stages/features/photographs/photo_container.h"

// Markers and segments: ITU-T T.81, annex B. EXIF in APP1: CIPA DC-008, 4.5.4.
namespace psfm {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kExifHeader = "Exif\0\0"sv;

bool is_frame_header(std::uint8_t marker) {
    // C4, C8 and CC lie in the range but are tables and extensions.
    return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

/// Markers without a length after them.
bool stands_alone(std::uint8_t marker) {
    return marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8);
}

/// What may follow a scan besides the end: tables, the next scan, the number of lines, comments.
bool may_follow_scan(std::uint8_t marker) {
    return marker == 0xC4 || marker == 0xCC || marker >= 0xDA;
}

/// Position of the marker that ends the entropy-coded data from `position` on, or the end of the
/// file. Within such data a byte FF is followed by 00 or by a restart marker; anything else that
/// cannot follow a scan is damage, which a decoder skips as well.
std::size_t find_scan_end(std::span<const std::uint8_t> bytes, std::size_t position) {
    while (position < bytes.size()) {
        const void* found = std::memchr(bytes.data() + position, 0xFF, bytes.size() - position);
        if (found == nullptr) break;
        position = static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - bytes.data());
        if (position + 1 >= bytes.size()) break;
        const std::uint8_t marker = bytes[position + 1];
        if (marker != 0xFF && (marker == 0xD9 || may_follow_scan(marker))) return position;
        ++position;
    }
    return bytes.size();
}

}  // namespace

PhotoContainer parse_jpeg(std::span<const std::uint8_t> bytes) {
    const ByteView view(bytes);
    PhotoContainer result;
    result.truncated = true;  // until the end-of-image marker is met
    std::size_t position = 2;
    while (view.has(position, 2)) {
        if (view.u8(position) != 0xFF || view.u8(position + 1) == 0xFF ||
            view.u8(position + 1) == 0) {
            ++position;  // fill bytes, or stray bytes between segments
            continue;
        }
        const std::uint8_t marker = view.u8(position + 1);
        position += 2;
        if (marker == 0xD9) {
            result.truncated = false;
            break;
        }
        if (stands_alone(marker)) continue;
        const std::size_t length = view.be16(position);
        if (length < 2 || !view.has(position, length)) break;
        if (is_frame_header(marker) && !result.size && length >= 8 && view.be16(position + 3) > 0) {
            result.size = PhotoSize{view.be16(position + 5), view.be16(position + 3)};
        }
        if (marker == 0xE1 && result.exif.empty() && view.matches(position + 2, kExifHeader)) {
            result.exif =
                view.part(position + 2 + kExifHeader.size(), length - 2 - kExifHeader.size());
        }
        position += length;
        if (marker == 0xDA) position = find_scan_end(bytes, position);
    }
    return result;
}

}  // namespace psfm
