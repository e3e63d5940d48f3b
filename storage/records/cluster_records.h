// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "graph/result.h"
#include "storage/records/record_key.h"
#include "storage/records/stored_values.h"

namespace psfm {

/// A cluster as it lies in the store: removed ones stay as tombstones with their last members.
struct ClusterRecord {
    StoredCluster cluster;
    bool removed = false;
    /// The solution that its latest one is read from, with all changes since; 0: the latest itself.
    std::uint32_t whole = 0;
};

/// The same number, never 0 where there is a solution.
std::uint32_t whole_revision(const ClusterRecord& record);

/// Payload of a cluster (FORMAT.md section 4).
/// @errors kInvalidArgument: no members or not ascending, solved_topology or
/// transfer_topology > topology
Result<std::string> encode_cluster(const ClusterRecord& record);

/// @errors kDamaged
Result<ClusterRecord> decode_cluster(ClusterId id, std::string_view payload);

/// Solutions that a later one has taken the place of, by what each is read from: the revision that
/// is whole, its own or an earlier one.
using SupersededSolutions = std::map<SolutionKey, std::uint32_t>;

/// Payload of such a solution's mark (FORMAT.md section 4).
std::string encode_superseded(const SolutionKey& key, std::uint32_t whole);

/// @return the revision that is whole @errors kDamaged
Result<std::uint32_t> decode_superseded(const SolutionKey& key, std::string_view payload);

}  // namespace psfm
