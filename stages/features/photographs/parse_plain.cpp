// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "stages/features/photographs/byte_view.h"
#include "stages/features/photographs/photo_container.h"

// Formats whose header gives offsets or sizes of plain data: TIFF 6.0, BMP, PNM (netpbm).
namespace psfm {
namespace {

/// A TIFF file in either byte order.
struct TiffView {
    ByteView view;
    bool little = true;

    std::uint32_t u16(std::uint64_t at) const { return little ? view.le16(at) : view.be16(at); }
    std::uint32_t u32(std::uint64_t at) const { return little ? view.le32(at) : view.be32(at); }

    /// Bytes of an element of the entry's type, as libtiff takes them for whole numbers.
    std::uint64_t element_size(std::uint64_t entry) const {
        switch (u16(entry + 2)) {
            case 1:  // BYTE, SBYTE
            case 6:
                return 1;
            case 3:  // SHORT, SSHORT
            case 8:
                return 2;
            case 16:  // LONG8, SLONG8, IFD8
            case 17:
            case 18:
                return 8;
            default:
                return 4;
        }
    }

    /// Element of an entry's array; values that fit in four bytes stand in the entry itself.
    std::uint64_t value(std::uint64_t entry, std::uint64_t index) const {
        const std::uint64_t width = element_size(entry);
        const bool is_inline = width * u32(entry + 4) <= 4;
        const std::uint64_t at = (is_inline ? entry + 8 : u32(entry + 8)) + width * index;
        if (width == 1) return view.u8(at);
        if (width == 2) return u16(at);
        if (width == 4) return u32(at);
        const std::uint64_t first = u32(at);
        const std::uint64_t second = u32(at + 4);
        return little ? second << 32U | first : first << 32U | second;
    }
};

/// Format: tags of TIFF 6.0.
constexpr std::uint32_t kWidthTag = 256;
constexpr std::uint32_t kHeightTag = 257;
constexpr std::uint32_t kStripOffsetsTag = 273;
constexpr std::uint32_t kStripSizesTag = 279;
constexpr std::uint32_t kTileOffsetsTag = 324;
constexpr std::uint32_t kTileSizesTag = 325;

bool is_space(std::uint8_t byte) {
    return byte == ' ' || (byte >= '\t' && byte <= '\r');
}

}  // namespace

PhotoContainer parse_tiff(std::span<const std::uint8_t> bytes) {
    const TiffView tiff{ByteView(bytes), bytes[0] == 'I'};
    PhotoContainer result;
    result.exif = bytes;
    const std::uint64_t directory = tiff.u32(4);
    const std::uint64_t count = tiff.u16(directory);
    if (!tiff.view.has(directory, 2 + 12 * count + 4)) {
        result.truncated = true;
        return result;
    }
    PhotoSize size;
    std::uint64_t offsets = 0;
    std::uint64_t sizes = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t entry = directory + 2 + 12 * i;
        const std::uint32_t tag = tiff.u16(entry);
        // The first of several counts, as for libtiff.
        if (tag == kWidthTag && size.width == 0) size.width = tiff.value(entry, 0);
        if (tag == kHeightTag && size.height == 0) size.height = tiff.value(entry, 0);
        if (tag == kStripOffsetsTag || tag == kTileOffsetsTag) offsets = entry;
        if (tag == kStripSizesTag || tag == kTileSizesTag) sizes = entry;
    }
    if (size.width > 0 && size.height > 0) result.size = size;
    if (offsets == 0 || sizes == 0) return result;
    // A strip has at least one byte, so there are at most as many as bytes.
    const std::uint64_t strips = std::min<std::uint64_t>(tiff.u32(offsets + 4), bytes.size());
    for (std::uint64_t i = 0; i < strips && !result.truncated; ++i) {
        result.truncated = !tiff.view.has(tiff.value(offsets, i), tiff.value(sizes, i));
    }
    return result;
}

PhotoContainer parse_bmp(std::span<const std::uint8_t> bytes) {
    const ByteView view(bytes);
    PhotoContainer result;
    if (view.le32(14) == 12) {  // OS/2 header
        result.size = PhotoSize{view.le16(18), view.le16(20)};
        return result;
    }
    const std::uint32_t height = view.le32(22);  // negative: rows from the top
    const bool is_negative = height > 0x7FFFFFFFU;
    result.size = PhotoSize{view.le32(18), is_negative ? std::uint64_t{~height} + 1 : height};
    const std::uint64_t row_bytes = (view.le16(28) * result.size->width + 31) / 32 * 4;
    const bool is_plain = view.le32(30) == 0;  // not run-length coded
    // Division: the product of two hostile numbers may not fit.
    const std::uint64_t room = view.size() - std::min<std::uint64_t>(view.size(), view.le32(10));
    result.truncated = is_plain && row_bytes > 0 && room / row_bytes < result.size->height;
    return result;
}

PhotoContainer parse_pnm(std::span<const std::uint8_t> bytes) {
    const ByteView view(bytes);
    const std::uint8_t kind = view.u8(1);
    const bool is_bitmap = kind == '1' || kind == '4';
    const std::size_t wanted = is_bitmap ? 2 : 3;
    std::array<std::uint64_t, 3> numbers{0, 0, 1};
    std::uint64_t position = 2;
    for (std::size_t i = 0; i < wanted; ++i) {
        while (is_space(view.u8(position)) || view.u8(position) == '#') {
            if (view.u8(position) == '#') {
                // OpenCV ends comments at either.
                while (view.has(position, 1) && view.u8(position) != '\n' &&
                       view.u8(position) != '\r') {
                    ++position;
                }
            } else {
                ++position;
            }
        }
        constexpr std::uint64_t kLimit = 1'000'000'000;  // Guard: of digits without end
        std::uint64_t number = 0;
        for (; view.u8(position) >= '0' && view.u8(position) <= '9'; ++position) {
            number = std::min(kLimit, number * 10 + (view.u8(position) - std::uint64_t{'0'}));
        }
        numbers[i] = number;
    }
    PhotoContainer result;
    result.size = PhotoSize{numbers[0], numbers[1]};
    if (kind == '5' || kind == '6') {
        const std::uint64_t row_bytes =
            numbers[0] * (kind == '6' ? 3 : 1) * (numbers[2] > 255 ? 2 : 1);
        const std::uint64_t room = view.size() - std::min<std::uint64_t>(view.size(), position + 1);
        result.truncated = row_bytes > 0 && room / row_bytes < numbers[1];
    }
    return result;
}

}  // namespace psfm
