// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "graph/ids.h"

namespace psfm {

/// Membership of one cluster. Invariant: members ascending, not empty.
struct ClusterMembers {
    ClusterId id{};
    std::vector<ImageId> members;
    bool operator==(const ClusterMembers&) const = default;
};

/// Images that changed cluster together.
struct MovedMembers {
    ClusterId from{};
    ClusterId to{};
    std::vector<ImageId> members;  ///< ascending
    bool operator==(const MovedMembers&) const = default;
};

/// What one new image (or one batch) changed in the clustering. Clusters that are in neither list
/// are untouched. A cluster keeps its id when the largest part of its former members stays together
/// there (ties: the part with the smallest member); when several clusters join, the largest one's
/// id survives (ties: smallest id).
struct ClusteringEdit {
    std::vector<ClusterMembers> changed;  ///< new or different membership, ascending by id
    std::vector<ClusterId> removed;       ///< ids that ceased to exist, ascending
    std::vector<MovedMembers> moved;      ///< ascending by (from, to); new images are in no `moved`
    bool operator==(const ClusteringEdit&) const = default;
};

}  // namespace psfm
