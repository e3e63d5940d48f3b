// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace psfm {

// The JSON library's writer and parser, compiled once: wherever they are used directly, they take
// the compiler some five seconds. All are thread-safe.

/// Bytes that are no UTF-8 (names of files) become U+FFFD.
/// @param indent  blanks a level; below 0: all in one line
std::string json_text(const nlohmann::json& value, int indent = -1);
std::string json_text(const nlohmann::ordered_json& value, int indent = -1);

/// Discarded (is_discarded) where the text is no JSON: nothing can be taken from it, and what tries
/// gets the library's exception.
nlohmann::json parse_json(std::string_view text);
nlohmann::ordered_json parse_ordered_json(std::string_view text);

}  // namespace psfm
