// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/jpeg_completeness.h"

#include <csetjmp>
#include <cstdio>
// jpeglib.h wants size_t and FILE to be there.
#include <jpeglib.h>

#include <algorithm>
#include <span>

namespace psfm {
namespace {

/// What libjpeg calls when something is wrong. It is C: errors leave by longjmp, past no object
/// with a destructor.
struct Complaints {
    jpeg_error_mgr manager{};  // first: libjpeg knows only this part
    std::jmp_buf on_error{};
};

extern "C" {
[[noreturn]] void leave(j_common_ptr reader) {
    std::longjmp(reinterpret_cast<Complaints*>(reader->err)->on_error, 1);
}
void count_warning(j_common_ptr reader, int level) {
    if (level < 0) ++reader->err->num_warnings;
}
void say_nothing(j_common_ptr /*reader*/) {}
}

/// Every coefficient of every component was sent to its last bit (ITU-T T.81, annex G).
bool is_refined(const jpeg_decompress_struct& reader) {
    if (reader.coef_bits == nullptr) return false;
    for (int component = 0; component < reader.num_components; ++component) {
        if (!std::all_of(reader.coef_bits[component], reader.coef_bits[component] + DCTSIZE2,
                         [](int missing_bits) { return missing_bits == 0; }))
            return false;
    }
    return true;
}

/// Decodes all, at an eighth of the size. libjpeg warns where data end before their last block.
bool decodes_in_whole(jpeg_decompress_struct& reader) {
    if (reader.progressive_mode != 0) {
        jpeg_read_coefficients(&reader);
        return is_refined(reader);
    }
    // Of what came in several scans a whole one could be missing without a warning.
    if (jpeg_has_multiple_scans(&reader) != 0) return false;
    reader.scale_num = 1;
    reader.scale_denom = 8;
    jpeg_start_decompress(&reader);
    const JDIMENSION width =
        reader.output_width * static_cast<JDIMENSION>(reader.output_components);
    JSAMPARRAY row =
        (*reader.mem->alloc_sarray)(reinterpret_cast<j_common_ptr>(&reader), JPOOL_IMAGE, width, 1);
    while (reader.output_scanline < reader.output_height) jpeg_read_scanlines(&reader, row, 1);
    jpeg_finish_decompress(&reader);
    return true;
}

bool has_all_data(std::span<const std::uint8_t> jpeg) {
    jpeg_decompress_struct reader{};
    Complaints complaints;
    reader.err = jpeg_std_error(&complaints.manager);
    complaints.manager.error_exit = leave;
    complaints.manager.emit_message = count_warning;
    complaints.manager.output_message = say_nothing;
    if (setjmp(complaints.on_error) != 0) {
        jpeg_destroy_decompress(&reader);
        return false;
    }
    jpeg_create_decompress(&reader);
    jpeg_mem_src(&reader, jpeg.data(), jpeg.size());
    jpeg_read_header(&reader, TRUE);
    const bool whole = decodes_in_whole(reader) && complaints.manager.num_warnings == 0;
    jpeg_destroy_decompress(&reader);
    return whole;
}

}  // namespace

bool mend_jpeg_end(std::vector<std::uint8_t>& bytes) {
    const bool has_half = !bytes.empty() && bytes.back() == 0xFF;
    if (!has_half) bytes.push_back(0xFF);
    bytes.push_back(0xD9);
    if (has_all_data(bytes)) return true;
    bytes.pop_back();
    if (!has_half) bytes.pop_back();
    return false;
}

}  // namespace psfm
