// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "graph/result.h"
#include "storage/session_store.h"

namespace psfm {

/// A cluster as it lies in the store: removed ones stay as tombstones with their last members.
struct ClusterRecord {
    StoredCluster cluster;
    bool removed = false;
};

/// Payload of a cluster (FORMAT.md section 4).
/// @errors kInvalidArgument: no members or not ascending, solved_topology or
/// transfer_topology > topology
Result<std::string> encode_cluster(const ClusterRecord& record);

/// @errors kDamaged
Result<ClusterRecord> decode_cluster(ClusterId id, std::string_view payload);

}  // namespace psfm
