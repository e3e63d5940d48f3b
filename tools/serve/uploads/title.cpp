// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/uploads/title.h"

#include <cstdint>

namespace psfm {
namespace {

struct Letter {
    std::uint32_t code = 0;
    std::size_t bytes = 0;  ///< 0: this is no UTF-8
};

/// Format: RFC 3629.
Letter first_letter(std::string_view text) {
    const auto lead = static_cast<unsigned char>(text.front());
    if (lead < 0x80) return {lead, 1};
    const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
    std::uint32_t code = lead & (0x7fU >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        const auto next = static_cast<unsigned char>(text[i]);
        if ((next & 0xc0U) != 0x80) return {};
        code = (code << 6U) | (next & 0x3fU);
    }
    const bool is_too_long = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
    const bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
    if (is_too_long || is_surrogate || code > 0x10ffff) return {};
    return {code, bytes};
}

bool is_shown(std::uint32_t code) {
    const bool is_control = code < 0x20 || (code >= 0x7f && code <= 0x9f);
    const bool turns = (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069) ||
                       code == 0x200e || code == 0x200f || code == 0x061c;
    return !is_control && !turns && code != 0x2028 && code != 0x2029;
}

}  // namespace

std::string title_of(std::string_view name) {
    constexpr std::size_t kLongest = 200;  // Guard: bounds what a user may write
    std::string title;
    while (!name.empty()) {
        const Letter letter = first_letter(name);
        const std::size_t bytes = letter.bytes == 0 ? 1 : letter.bytes;
        if (title.size() + bytes > kLongest) break;
        if (letter.bytes != 0 && is_shown(letter.code)) title += name.substr(0, bytes);
        name.remove_prefix(bytes);
    }
    return title.find_first_not_of(' ') == std::string::npos ? std::string() : title;
}

}  // namespace psfm
