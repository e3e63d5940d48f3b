// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/shell_word.h"

#include <algorithm>

namespace psfm {
namespace {

/// Asked without the locale, in which more would be letters.
bool means_itself(char c) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    const bool is_digit = c >= '0' && c <= '9';
    return is_letter || is_digit ||
           std::string_view("-._/+=:,@%").find(c) != std::string_view::npos;
}

}  // namespace

std::string shell_word(std::string_view argument) {
    if (!argument.empty() && std::ranges::all_of(argument, means_itself))
        return std::string(argument);
    std::string word = "'";
    for (const char c : argument) {
        if (c == '\'')
            word += R"('\'')";
        else
            word += c;
    }
    return word + '\'';
}

}  // namespace psfm
