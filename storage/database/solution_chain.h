// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "storage/database/read_view.h"
#include "storage/records/record_key.h"
#include "storage/records/solution_records.h"

// Internal: solutions that are stored as changes to others, read with what they change.

namespace psfm {

/// Guard: records that one solution is read from, at most. Raised: less is written, and more is
/// read when a session is opened; a record that says of more is damaged. Ours; not tuned.
inline constexpr std::uint32_t kLongestChain = 16;

/// Poses and cameras of a solution; nothing when there are none.
/// @errors kDamaged (what it is made from, too), kIo
Result<std::optional<Reconstruction>> read_poses(const ReadView& view, const SolutionKey& key);

/// Points of a solution, `since` being 0; nothing when its record was dropped.
/// @errors kDamaged (what it is made from, too), kIo
Result<std::optional<SolutionPoints>> read_points(const ReadView& view, const SolutionKey& key);

/// The revision that a solution is a change to, by its poses, a smaller one; 0: it is whole;
/// nothing: there is no such solution. @errors kDamaged, kIo
Result<std::optional<std::uint32_t>> revision_before(const ReadView& view, const SolutionKey& key);

}  // namespace psfm
