// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace psfm {

// Format: exit codes (docs/commands.md, "Exit codes"); others are 0, and 1 for anything else.
inline constexpr int kUsageError = 2;
inline constexpr int kBadInput = 3;
inline constexpr int kStoreDamaged = 4;

}  // namespace psfm
