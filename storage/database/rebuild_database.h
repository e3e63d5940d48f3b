// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "graph/result.h"

namespace psfm {

/// A copy of a session whose database does not open any more, with an index made anew from the
/// tables and logs that can be read. Records may be missing or old in it: for salvage only.
/// @param copy  made; what is there is removed first. REQUIRES: nobody writes to the session
/// @errors kDamaged (nothing can be made of it), kNoSpace, kIo
Result<void> rebuild_database(const std::filesystem::path& session,
                              const std::filesystem::path& copy);

}  // namespace psfm
