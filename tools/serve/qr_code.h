// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace psfm {

/// ISO/IEC 18004, in half blocks for a terminal, dark on light whatever its colours; empty for what
/// is too long.
std::string qr_code(const std::string& text);

}  // namespace psfm
