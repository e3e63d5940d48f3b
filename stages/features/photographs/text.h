// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace psfm {

/// Whether all bytes form UTF-8 (RFC 3629: no overlong forms, no surrogates, at most U+10FFFF).
bool is_valid_utf8(std::string_view text);

/// Whether the text holds a control character (U+0000 … U+001F, U+007F, and U+0080 … U+009F in
/// UTF-8).
bool has_control_characters(std::string_view text);

/// The text on one line: control characters, backslashes and bytes that are no UTF-8 become \xNN.
std::string printable(std::string_view text);

}  // namespace psfm
