// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's
class App;
}

namespace psfm {

/// For CLI::Option::check of an option whose type has 64 bits and no sign: CLI11 takes -1 for the
/// largest number of these, and what is larger still, too.
/// @return what is wrong, empty if nothing
std::string whole_number_problem(const std::string& text);

/// Every option and positional that the command and its commands have so far refuses an empty
/// value, as it comes of a shell's variable that is not set.
void refuse_empty_values(CLI::App& command);

}  // namespace psfm
