// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/resident_models.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace psfm {

Result<void> ResidentModels::use(std::span<const ClusterId> clusters, ClusterTable& table,
                                 const SessionReader& store) {
    ++uses_;
    for (const ClusterId id : clusters) {
        const auto entry = table.entries().find(id);
        if (entry == table.entries().end()) continue;
        used_[id] = uses_;
        if (!entry->second.published.rests) continue;
        const auto stored = store.solution(id);
        if (!stored.ok()) return stored.error();
        if (!stored->has_value() || (*stored)->revision != entry->second.published.revision) {
            return Error{ErrorCode::kDamaged, "the model of cluster " +
                                                  std::to_string(index_of(id)) +
                                                  " is not in the session any more; `psfm check` "
                                                  "tells what else is not"};
        }
        table.wake(id, (*stored)->model);
    }
    return {};
}

void ResidentModels::release(ClusterTable& table) {
    std::size_t bytes = 0;
    std::vector<std::pair<std::uint64_t, ClusterId>> oldest;
    for (const auto& [id, entry] : table.entries()) {
        if (!entry.published.model) continue;
        bytes += entry.published.model->points.bytes();
        const std::uint64_t used = used_[id];
        if (used + kUsesKept <= uses_ && may_rest(entry)) oldest.emplace_back(used, id);
    }
    std::erase_if(used_, [&](const auto& use) { return !table.entries().contains(use.first); });
    std::ranges::sort(oldest);
    for (const auto& [used, id] : oldest) {
        if (bytes <= budget_) break;
        bytes -= table.entries().at(id).published.model->points.bytes();
        table.rest(id);
    }
}

}  // namespace psfm
