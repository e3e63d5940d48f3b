// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/decode_heif.h"

#include <libheif/heif.h>

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "stages/features/photographs/byte_view.h"
#include "stages/features/photographs/photo_mask.h"
#include "stages/features/photographs/text.h"

namespace psfm {
namespace {

template <auto Free>
struct Deleter {
    template <typename T>
    void operator()(T* pointer) const {
        Free(pointer);
    }
};
using Context = std::unique_ptr<heif_context, Deleter<heif_context_free>>;
using Handle = std::unique_ptr<heif_image_handle, Deleter<heif_image_handle_release>>;
using Picture = std::unique_ptr<heif_image, Deleter<heif_image_release>>;

Error heif_failure(const heif_error& error) {
    const std::string reason =
        error.message == nullptr ? "unknown error" : printable(error.message);
    return {ErrorCode::kUnreadable, "cannot be decoded as HEIF (" + reason +
                                        "); copy the file again, or export it as JPEG"};
}

/// HEIF keeps four bytes of offset, and mostly JPEG's "Exif\0\0", in front of the TIFF structure.
std::vector<std::uint8_t> read_exif_block(const heif_image_handle* handle) {
    heif_item_id id = 0;
    if (heif_image_handle_get_list_of_metadata_block_IDs(handle, "Exif", &id, 1) != 1) return {};
    std::vector<std::uint8_t> block(heif_image_handle_get_metadata_size(handle, id));
    if (block.size() < 4 ||
        heif_image_handle_get_metadata(handle, id, block.data()).code != heif_error_Ok) {
        return {};
    }
    const ByteView view(block);
    const auto tiff = view.part(std::uint64_t{4} + view.be32(0), block.size());
    return {tiff.begin(), tiff.end()};
}

}  // namespace

Result<HeifPhoto> decode_heif(std::span<const std::uint8_t> bytes, double max_pixels) {
    const Context context(heif_context_alloc());
    if (!context)
        return Error{ErrorCode::kUnreadable, "cannot be decoded: out of memory; use fewer threads"};
    heif_error error = heif_context_read_from_memory_without_copy(context.get(), bytes.data(),
                                                                  bytes.size(), nullptr);
    if (error.code != heif_error_Ok) return heif_failure(error);
    heif_image_handle* raw_handle = nullptr;
    error = heif_context_get_primary_image_handle(context.get(), &raw_handle);
    const Handle handle(raw_handle);
    if (error.code != heif_error_Ok) return heif_failure(error);

    const double pixels = static_cast<double>(heif_image_handle_get_width(handle.get())) *
                          static_cast<double>(heif_image_handle_get_height(handle.get()));
    if (pixels > max_pixels) {
        return Error{ErrorCode::kUnreadable,
                     "has " + std::to_string(static_cast<long>(pixels / 1e6)) +
                         " megapixels, above the limit of " +
                         std::to_string(static_cast<long>(max_pixels / 1e6)) + "; reduce it"};
    }
    const bool has_alpha = heif_image_handle_has_alpha_channel(handle.get()) != 0;
    heif_image* raw_picture = nullptr;
    error = heif_decode_image(
        handle.get(), &raw_picture, heif_colorspace_RGB,
        has_alpha ? heif_chroma_interleaved_RGBA : heif_chroma_interleaved_RGB, nullptr);
    const Picture picture(raw_picture);
    if (error.code != heif_error_Ok) return heif_failure(error);

    int stride = 0;
    std::uint8_t* data = heif_image_get_plane(picture.get(), heif_channel_interleaved, &stride);
    const int width = heif_image_get_width(picture.get(), heif_channel_interleaved);
    const int height = heif_image_get_height(picture.get(), heif_channel_interleaved);
    if (data == nullptr || width <= 0 || height <= 0) {
        return Error{ErrorCode::kUnreadable, "holds no picture; export it as JPEG"};
    }
    HeifPhoto photo;
    const cv::Mat rgb(height, width, has_alpha ? CV_8UC4 : CV_8UC3, data,
                      static_cast<std::size_t>(stride));
    cv::cvtColor(rgb, photo.colour, has_alpha ? cv::COLOR_RGBA2BGR : cv::COLOR_RGB2BGR);
    if (has_alpha) {
        cv::Mat alpha;
        cv::extractChannel(rgb, alpha, 3);
        photo.mask = mask_from_alpha(alpha);
    }
    photo.exif = read_exif_block(handle.get());
    return photo;
}

bool can_decode_heif() {
    return heif_have_decoder_for_format(heif_compression_HEVC) != 0;
}

}  // namespace psfm
