// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/files/image_name.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>

namespace psfm {
namespace {

/// Guard: longest path that Linux opens.
constexpr std::size_t kMaxNameLength = 4096;

/// Takes the first character off a text that is not empty; nothing when its bytes are not UTF-8
/// (RFC 3629: the shortest form, no surrogates, at most 10FFFF).
std::optional<std::uint32_t> take_character(std::string_view& text) {
    const auto first = static_cast<unsigned char>(text.front());
    const auto leading_ones = static_cast<std::size_t>(std::countl_one(first));
    const std::size_t length = std::max<std::size_t>(leading_ones, 1);
    if (leading_ones == 1 || length > 4 || length > text.size()) return std::nullopt;
    std::uint32_t character = first & (0xffU >> leading_ones);
    for (std::size_t i = 1; i < length; ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if ((byte & 0xc0U) != 0x80U) return std::nullopt;
        character = character << 6U | (byte & 0x3fU);
    }
    // Format: UTF-8, the least character of so many bytes.
    constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = character >= 0xd800 && character <= 0xdfff;
    if (character < kLeast[length] || character > 0x10ffff || surrogate) return std::nullopt;
    text.remove_prefix(length);
    return character;
}

}  // namespace

std::optional<std::string> problem_of_name(std::string_view name) {
    if (name.empty()) return "is empty";
    if (name.size() > kMaxNameLength) return "is longer than a path can be";
    for (std::string_view rest = name; !rest.empty();) {
        const auto character = take_character(rest);
        if (!character) return "is not UTF-8";
        if (*character < 0x20 || (*character >= 0x7f && *character < 0xa0)) {
            return "has control characters";
        }
    }
    const std::filesystem::path path(name);
    if (path.is_absolute()) return "is an absolute path";
    if (std::ranges::find(path, "..") != path.end()) return "leads out of the photograph folder";
    if (!path.has_filename() || path.filename() == ".") return "names a folder";
    return std::nullopt;
}

}  // namespace psfm
