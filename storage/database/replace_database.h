// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "graph/result.h"

namespace psfm {

/// Puts the database of a repaired session in the place of a damaged one. The damaged session's
/// folder keeps its name, and all else that lies in it (photographs, users) stays where it is. Each
/// step is one rename, on the disk before the next one; what was cut off in between, the same call
/// finishes. Between two of them the session has no database: it opens with an error (kDamaged).
/// @param session  REQUIRES: the caller holds its lock
/// @param repaired  the new session, whole, closed, on the same file system; gone afterwards
/// @param damaged  what `repaired` is called afterwards, with the damaged database in it
/// @errors kNoSpace, kIo (among others: something else has that name)
Result<void> replace_database(const std::filesystem::path& session,
                              const std::filesystem::path& repaired,
                              const std::filesystem::path& damaged);

/// Whether replace_database() was cut off with this repaired session.
bool is_replacing(const std::filesystem::path& repaired);

}  // namespace psfm
