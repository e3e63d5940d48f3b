// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace psfm {

/// The program: all commands are registered, and the one that the user has chosen is run.
/// @param version  what --version prints
/// @return exit code (docs/commands.md, "Exit codes")
int run_command_line(int argc, char** argv, const std::string& version);

}  // namespace psfm
