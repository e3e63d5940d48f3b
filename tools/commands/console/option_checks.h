// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace psfm {

/// For CLI::Option::check of an option whose type has 64 bits and no sign: CLI11 takes -1 for the
/// largest number of these, and what is larger still, too.
/// @return what is wrong, empty if nothing
std::string whole_number_problem(const std::string& text);

}  // namespace psfm
