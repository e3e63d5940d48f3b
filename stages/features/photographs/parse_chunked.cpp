// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/byte_view.h"
#include "stages/features/photographs/photo_container.h"

// Formats made of length-prefixed parts: PNG (W3C PNG, third edition), WebP (RFC 9649) and
// JPEG 2000 (ITU-T T.800, annex I).
namespace psfm {
namespace {

using std::string_view_literals::operator""sv;

/// "JpgTiffExif->JP2": the box that exiv2, ExifTool and Photoshop keep EXIF in.
constexpr std::string_view kJpeg2000ExifId = "JpgTiffExif->JP2"sv;

PhotoSize lossy_webp_size(const ByteView& view, std::uint64_t bitstream) {
    return {view.le16(bitstream + 6) & 0x3FFFU, view.le16(bitstream + 8) & 0x3FFFU};
}

PhotoSize lossless_webp_size(const ByteView& view, std::uint64_t bitstream) {
    const std::uint32_t bits = view.le32(bitstream + 1);
    return {(bits & 0x3FFFU) + 1, ((bits >> 14U) & 0x3FFFU) + 1};
}

std::optional<PhotoSize> webp_size(const ByteView& view, std::uint64_t chunk, std::uint64_t data) {
    if (view.matches(chunk, "VP8X"sv)) {
        return PhotoSize{std::uint64_t{view.le24(data + 4)} + 1,
                         std::uint64_t{view.le24(data + 7)} + 1};
    }
    if (view.matches(chunk, "VP8 "sv)) return lossy_webp_size(view, data);
    if (view.matches(chunk, "VP8L"sv)) return lossless_webp_size(view, data);
    return std::nullopt;
}

/// What libwebp makes of a file whose first chunk is none of WebP's: a bitstream without a chunk
/// around it, which the name of a chunk can be as well.
PhotoSize bare_webp_size(const ByteView& view, std::uint64_t start) {
    return view.matches(start, "/"sv) ? lossless_webp_size(view, start)
                                      : lossy_webp_size(view, start);
}

/// Size of an image in a JPEG 2000 codestream (T.800, A.5.1), which decoders go by, whatever the
/// boxes around it say.
std::optional<PhotoSize> codestream_size(const ByteView& view, std::uint64_t start) {
    if (!view.matches(start, "\xFF\x4F\xFF\x51"sv)) return std::nullopt;
    const auto side = [&](std::uint64_t at) {
        return std::uint64_t{view.be32(at)} - std::min(view.be32(at), view.be32(at + 8));
    };
    return PhotoSize{side(start + 8), side(start + 12)};
}

/// The larger one of each side.
PhotoSize larger(const PhotoSize& a, const PhotoSize& b) {
    return {std::max(a.width, b.width), std::max(a.height, b.height)};
}

}  // namespace

PhotoContainer parse_png(std::span<const std::uint8_t> bytes) {
    const ByteView view(bytes);
    PhotoContainer result;
    result.truncated = true;  // until the last chunk is met
    std::uint64_t position = 8;
    while (view.has(position, 12)) {
        const std::uint64_t length = view.be32(position);
        if (!view.has(position, 12 + length)) break;
        // The first counts, as for decoders; another one is damage.
        if (view.matches(position + 4, "IHDR"sv) && !result.size) {
            result.size = PhotoSize{view.be32(position + 8), view.be32(position + 12)};
        }
        if (view.matches(position + 4, "eXIf"sv)) result.exif = view.part(position + 8, length);
        if (view.matches(position + 4, "IEND"sv)) {
            result.truncated = false;
            break;
        }
        position += 12 + length;
    }
    return result;
}

PhotoContainer parse_webp(std::span<const std::uint8_t> bytes) {
    const ByteView view(bytes);
    PhotoContainer result;
    result.truncated = !view.has(8, view.le32(4));
    std::uint64_t position = 12;
    if (view.has(position, 8) && !webp_size(view, position, position + 8))
        result.size = bare_webp_size(view, position);
    while (view.has(position, 8)) {
        const std::uint64_t length = view.le32(position + 4);
        const std::uint64_t data = position + 8;
        if (!result.size) result.size = webp_size(view, position, data);
        if (view.matches(position, "EXIF"sv)) {
            // Some writers keep JPEG's header in front.
            const std::uint64_t skip = view.matches(data, "Exif\0\0"sv) && length >= 6 ? 6 : 0;
            result.exif = view.part(data + skip, length - skip);
        }
        position = data + length + length % 2;
    }
    return result;
}

PhotoContainer parse_jpeg2000(std::span<const std::uint8_t> bytes) {
    const ByteView view(bytes);
    PhotoContainer result;
    result.truncated = true;  // until a codestream that ends is met
    std::uint64_t position = 0;
    while (view.has(position, 8)) {
        std::uint64_t length = view.be32(position);
        std::uint64_t header = 8;
        if (length == 1) {  // 64-bit length
            length = (std::uint64_t{view.be32(position + 8)} << 32U) | view.be32(position + 12);
            header = 16;
        }
        if (length == 0) length = view.size() - position;  // to the end of the file
        if (length < header || !view.has(position, length)) break;
        if (view.matches(position + 4, "jp2h"sv) && view.matches(position + header + 4, "ihdr"sv)) {
            const PhotoSize size{view.be32(position + header + 12),
                                 view.be32(position + header + 8)};
            result.size = larger(result.size.value_or(PhotoSize{}), size);
        }
        if (view.matches(position + 4, "uuid"sv) &&
            view.matches(position + header, kJpeg2000ExifId)) {
            result.exif = view.part(position + header + 16,
                                    length - std::min<std::uint64_t>(length, header + 16));
        }
        if (view.matches(position + 4, "jp2c"sv)) {
            if (const auto size = codestream_size(view, position + header))
                result.size = larger(result.size.value_or(PhotoSize{}), *size);
            result.truncated = !view.matches(position + length - 2, "\xFF\xD9"sv);
        }
        position += length;
    }
    return result;
}

}  // namespace psfm
