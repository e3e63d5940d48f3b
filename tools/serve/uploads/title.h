// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace psfm {

/// A name that somebody gave, as people are shown it: one line of UTF-8 of at most 200 bytes,
/// without controls and without what turns the direction of text round (Unicode TR 36, section
/// 2.4). Bytes that are no UTF-8 are left out. Empty when nothing but blanks is left.
std::string title_of(std::string_view name);

}  // namespace psfm
