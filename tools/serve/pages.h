// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace psfm {

/// Whether this program was built with its pages: where three.js could not be fetched it has none.
bool has_pages();

/// A file of the pages, as it was built into the program: "viewer.js", "capture.js", "style.css",
/// "three.LICENSE"; empty when there is none of that name.
std::string_view page_file(std::string_view name);

}  // namespace psfm
