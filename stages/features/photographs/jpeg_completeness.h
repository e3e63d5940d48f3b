// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace psfm {

/// Adds the end marker to a JPEG file that lacks it, where nothing else is missing: every block of
/// the picture is there, and of a progressive one every bit of it. Such files come from copies and
/// recoveries that lost the last bytes, and from cameras that never wrote them.
/// @param bytes  a JPEG without end marker; as it was unless true is returned
/// Cost: decodes all of the picture's entropy-coded data. Thread-safe.
bool mend_jpeg_end(std::vector<std::uint8_t>& bytes);

}  // namespace psfm
