// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace psfm {

/// "1 cluster", "2 clusters". @param noun  one of them; its plural ends in s
std::string counted(std::uint64_t count, std::string_view noun);

/// "a, b, c and 7 more": the first five.
std::string some_of(const std::vector<std::string>& names);

/// An argument as it can be copied into a POSIX shell: as it is where it holds letters, digits and
/// -._/+=:,@% only, else in single quotes.
std::string shell_word(std::string_view argument);

}  // namespace psfm
