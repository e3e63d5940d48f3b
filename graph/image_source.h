// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace psfm {

/// Where the file of a photograph was last seen, and what it was like then. Nothing is known of the
/// images of databases, and of those that earlier programs took in.
struct ImageFile {
    std::string folder;            ///< absolute; the image's name is relative to it
    std::int64_t size = 0;         ///< [bytes]
    std::int64_t modified_ns = 0;  ///< by the file system's clock
    bool operator==(const ImageFile&) const = default;
};

/// What a session knows of where an image came from, beside what its pixels and EXIF data say.
struct ImageSource {
    ImageFile file;
    std::vector<std::uint8_t> signature;  ///< what it shows at a glance; empty: not known
    std::uint64_t mask_hash = 0;          ///< xxHash64 of the mask file that was used; 0: none was
    /// Taken out of the session again: nothing of it is used, and its name may be another's.
    bool removed = false;
    /// Of a taken-in model whose places have more digits than float: what those of the image's
    /// first features lack, x, y, … [px]. Empty: nothing.
    std::vector<float> place_remainders = {};
    bool operator==(const ImageSource&) const = default;
};

}  // namespace psfm
