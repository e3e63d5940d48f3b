// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Whole photographs through their decoders. The limit on pixels is low, so that a file that gets
// past it shows in the memory it takes (tools/fuzz limits that).
#include "stages/features/photographs/read_photo.h"
#include "tests/fuzz/fuzz_input.h"

namespace psfm {

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::InputFolder folder;
    ReadPhotoOptions options;
    options.max_megapixels = 0.25;
    options.max_file_mib = 1;
    const PhotoFile file{folder.write("photo", {data, size}), "photo"};
    const auto photo = read_photo(file, options);
    if (!photo) {
        const std::string& message = photo.error().message;
        fuzz::require(message.starts_with("photo: ") && message.find('\n') == std::string::npos,
                      "a refusal is one line that names the photograph");
        return 0;
    }
    fuzz::require(photo->colour.type() == CV_8UC3 && photo->grey.size() == photo->colour.size(),
                  "photographs are 8-bit BGR beside their grey");
    fuzz::require(photo->colour.total() <= 250'000, "the limit on pixels holds");
    return 0;
}

}  // namespace psfm
