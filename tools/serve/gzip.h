// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace psfm {

/// What many get wants more effort than what one does: kLeast takes a fifth of the time for a fifth
/// more bytes, of `GET /session` of 600 images.
enum class GzipEffort { kLeast, kUsual };

/// RFC 1952, zlib's level 1 or 6; equal bytes for equal input.
std::string gzipped(std::string_view bytes, GzipEffort effort = GzipEffort::kUsual);

/// RFC 4648, with padding.
std::string base64(std::string_view bytes);

}  // namespace psfm
