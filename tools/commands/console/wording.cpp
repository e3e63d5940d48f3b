// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/wording.h"

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

std::string counted(std::uint64_t count, std::string_view noun) {
    return std::to_string(count) + ' ' + std::string(noun) + (count == 1 ? "" : "s");
}

std::string some_of(const std::vector<std::string>& names) {
    constexpr std::size_t kShown = 5;  // Format: names in a message
    std::string list;
    for (std::size_t i = 0; i < std::min(names.size(), kShown); ++i)
        list += (i == 0 ? "" : ", ") + names[i];
    if (names.size() > kShown) list += " and " + std::to_string(names.size() - kShown) + " more";
    return list;
}

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
