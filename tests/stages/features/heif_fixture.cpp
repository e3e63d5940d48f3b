// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/stages/features/heif_fixture.h"

#include <libheif/heif.h>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace psfm::testing {
namespace {

heif_error append(heif_context*, const void* data, std::size_t size, void* target) {
    const auto* begin = static_cast<const std::uint8_t*>(data);
    static_cast<Bytes*>(target)->insert(static_cast<Bytes*>(target)->end(), begin, begin + size);
    return {heif_error_Ok, heif_suberror_Unspecified, ""};
}

}  // namespace

namespace {

Bytes encode_with(heif_compression_format format, const cv::Mat& bgr, const Bytes& exif) {
#ifdef __SANITIZE_ADDRESS__
    const __lsan::ScopedDisabler known_leak;  // in x265's encoder, which only this test uses
#endif
    heif_context* context = heif_context_alloc();
    heif_encoder* encoder = nullptr;
    Bytes bytes;
    if (heif_context_get_encoder_for_format(context, format, &encoder).code == heif_error_Ok) {
        heif_encoder_set_lossy_quality(encoder, 95);
        heif_image* image = nullptr;
        heif_image_create(bgr.cols, bgr.rows, heif_colorspace_RGB, heif_chroma_interleaved_RGB,
                          &image);
        heif_image_add_plane(image, heif_channel_interleaved, bgr.cols, bgr.rows, 8);
        int stride = 0;
        std::uint8_t* plane = heif_image_get_plane(image, heif_channel_interleaved, &stride);
        cv::Mat rgb(bgr.rows, bgr.cols, CV_8UC3, plane, static_cast<std::size_t>(stride));
        cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
        heif_image_handle* handle = nullptr;
        heif_context_encode_image(context, image, encoder, nullptr, &handle);
        if (!exif.empty()) {
            heif_context_add_exif_metadata(context, handle, exif.data(),
                                           static_cast<int>(exif.size()));
        }
        heif_writer writer{1, append};
        heif_context_write(context, &writer, &bytes);
        heif_image_handle_release(handle);
        heif_image_release(image);
        heif_encoder_release(encoder);
    }
    heif_context_free(context);
    return bytes;
}

}  // namespace

Bytes encode_heif(const cv::Mat& bgr, const Bytes& exif) {
    return encode_with(heif_compression_HEVC, bgr, exif);
}

Bytes encode_avif(const cv::Mat& bgr) {
    return encode_with(heif_compression_AV1, bgr, {});
}

}  // namespace psfm::testing
