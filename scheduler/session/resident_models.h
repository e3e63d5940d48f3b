// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

#include "graph/ids.h"
#include "graph/result.h"
#include "scheduler/session/cluster_table.h"
#include "storage/session/session_store.h"

namespace psfm {

/// Decides which clusters rest: the points of models that a solve, a merge or an adoption has
/// looked at lately are in memory, those of others in the store. A value, owned by the commit node.
/// Ours (docs/notebook/2026-11-25-soak.md).
class ResidentModels {
  public:
    /// Guard: models used so many times ago or less stay in any case. Lowered: those that are
    /// looked at in turn are read again and again; raised: more memory.
    static constexpr std::uint64_t kUsesKept = 32;

    /// @param bytes  of points in memory, while some are of clusters that may rest. More: fewer
    /// reads from the store.
    void set_budget(std::size_t bytes) { budget_ = bytes; }

    /// Somebody is about to look at the points of these: they are read back where they rest.
    /// Clusters that are not in the table are left out.
    /// @errors those of the store
    Result<void> use(std::span<const ClusterId> clusters, ClusterTable& table,
                     const SessionReader& store);
    /// Where there are more bytes than the budget: lets clusters rest that were used longest ago.
    void release(ClusterTable& table);

  private:
    std::map<ClusterId, std::uint64_t> used_;  ///< number of the last use
    std::size_t budget_ = std::size_t{32} << 20U;
    std::uint64_t uses_ = 0;
};

}  // namespace psfm
