// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>

#include "storage/check/check_report.h"
#include "storage/database/database.h"

// Internal: SessionReader::check.

namespace psfm {

/// Reads every record of every family: checksums, envelope, grammar, meaning, and what records say
/// of each other. Damage is in the report; an error only when nothing could be read at all.
/// @param progress  called now and then with the number of records seen; may be empty
Result<CheckReport> check_session(const Database& database,
                                  const std::function<void(std::uint64_t done)>& progress);

}  // namespace psfm
