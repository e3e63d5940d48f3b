// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace psfm {

/// An argument as it can be copied into a POSIX shell: as it is where it holds letters, digits and
/// -._/+=:,@% only, else in single quotes.
std::string shell_word(std::string_view argument);

}  // namespace psfm
