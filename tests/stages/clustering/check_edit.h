// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "stages/clustering/clustering_state.h"

namespace psfm::test {

/// Applies an edit to a copy of the memberships, as a reader of edits would, and checks its lists.
inline void expect_edit_tells_all(const std::map<ClusterId, std::vector<ImageId>>& before,
                                  const ClusteringState& after, const ClusteringEdit& edit,
                                  std::size_t former_size) {
    std::map<ClusterId, std::vector<ImageId>> replayed = before;
    std::map<ImageId, ClusterId> owner;
    for (const auto& [id, members] : before) {
        for (const ImageId image : members) owner[image] = id;
    }
    for (const ClusterId id : edit.removed) ASSERT_EQ(replayed.erase(id), 1U);
    for (const ClusterMembers& cluster : edit.changed) {
        ASSERT_FALSE(cluster.members.empty());
        const auto known = before.find(cluster.id);
        if (known != before.end()) {
            ASSERT_NE(known->second, cluster.members);
        }
        replayed[cluster.id] = cluster.members;
    }
    ASSERT_EQ(replayed, after.members);
    ASSERT_TRUE(std::ranges::is_sorted(edit.changed, {}, &ClusterMembers::id));
    ASSERT_TRUE(std::ranges::is_sorted(edit.removed));

    std::map<std::pair<ClusterId, ClusterId>, std::vector<ImageId>> moved;
    for (const auto& [image, from] : owner) {
        const ClusterId to = after.cluster_of[index_of(image)];
        if (to != from) moved[{from, to}].push_back(image);
    }
    std::vector<MovedMembers> expected;
    for (const auto& [way, images] : moved) expected.push_back({way.first, way.second, images});
    ASSERT_EQ(edit.moved, expected);
    ASSERT_EQ(owner.size(), former_size);
}

}  // namespace psfm::test
