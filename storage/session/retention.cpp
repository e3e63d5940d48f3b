// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/session/retention.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <utility>

namespace psfm {
namespace {

const StoredPlacement* find_placement(const StoredSceneVersion& scene, const SolutionKey& key) {
    const auto found =
        std::ranges::lower_bound(scene.placements, key.cluster, {}, &StoredPlacement::cluster);
    const bool same = found != scene.placements.end() && found->cluster == key.cluster &&
                      found->revision == key.revision;
    return same ? &*found : nullptr;
}

std::set<ImageId> unsolved_images(const std::map<ClusterId, ClusterRecord>& clusters) {
    std::set<ImageId> images;
    for (const auto& [id, record] : clusters) {
        if (record.removed || record.cluster.solved_topology == record.cluster.topology) continue;
        images.insert(record.cluster.members.begin(), record.cluster.members.end());
    }
    return images;
}

}  // namespace

bool refers_to(const StoredSceneVersion& scene, const SolutionKey& key) {
    return find_placement(scene, key) != nullptr;
}

bool keeps_points(const SceneRecord* latest, const SolutionKey& key) {
    if (latest == nullptr) return false;
    const StoredPlacement* placement = find_placement(latest->scene, key);
    if (placement == nullptr) return false;
    return latest
        ->points_kept[static_cast<std::size_t>(placement - latest->scene.placements.data())];
}

std::vector<bool> points_kept_by(const StoredSceneVersion& next, const SceneRecord* latest,
                                 History history) {
    std::vector<bool> kept;
    kept.reserve(next.placements.size());
    for (const StoredPlacement& placement : next.placements) {
        kept.push_back(history == History::kFull ||
                       keeps_points(latest, {placement.cluster, placement.revision}));
    }
    return kept;
}

std::set<SolutionKey> recycled_solutions(const std::map<ClusterId, ClusterRecord>& clusters) {
    std::set<SolutionKey> recycled;
    for (const auto& [id, record] : clusters) {
        const StoredCluster& cluster = record.cluster;
        if (!record.removed && cluster.solved_topology < cluster.transfer_topology)
            recycled.insert(cluster.recycled.begin(), cluster.recycled.end());
    }
    return recycled;
}

std::vector<SolutionKey> droppable_solutions(const SupersededSolutions& superseded,
                                             const StoredSceneVersion& next,
                                             const std::map<ClusterId, ClusterRecord>& clusters) {
    std::set<ImageId> unsolved;
    bool have_unsolved = false;
    const auto awaited = [&](const SolutionKey& key) {
        const auto found = clusters.find(key.cluster);
        const bool last_of_removed = found != clusters.end() && found->second.removed &&
                                     found->second.cluster.revision == key.revision;
        if (!last_of_removed) return false;
        if (!have_unsolved) unsolved = unsolved_images(clusters);
        have_unsolved = true;
        return std::ranges::any_of(found->second.cluster.members,
                                   [&](ImageId member) { return unsolved.contains(member); });
    };
    const std::set<SolutionKey> recycled = recycled_solutions(clusters);
    std::vector<SolutionKey> droppable;
    const std::vector<std::pair<SolutionKey, std::uint32_t>> latest_first(superseded.rbegin(),
                                                                          superseded.rend());
    // From the latest solution of each cluster backwards: the oldest one that is read from.
    std::optional<ClusterId> cluster;
    std::uint32_t read_from = 0;
    for (const auto& [key, whole] : latest_first) {
        if (cluster != key.cluster) {
            cluster = key.cluster;
            const auto found = clusters.find(key.cluster);
            const bool is_there = found != clusters.end() && !found->second.removed;
            read_from = is_there ? whole_revision(found->second)
                                 : std::numeric_limits<std::uint32_t>::max();
        }
        if (refers_to(next, key) || awaited(key) || recycled.contains(key))
            read_from = std::min(read_from, whole);
        else if (key.revision < read_from)
            droppable.push_back(key);
    }
    return droppable;
}

std::vector<SolutionKey> referred_solutions(const SupersededSolutions& superseded,
                                            const StoredSceneVersion& scene,
                                            const std::map<ClusterId, ClusterRecord>& clusters) {
    std::vector<SolutionKey> referred;
    for (const StoredPlacement& placement : scene.placements) {
        const SolutionKey last{placement.cluster, placement.revision};
        const auto mark = superseded.find(last);
        const auto cluster = clusters.find(placement.cluster);
        std::uint32_t first = placement.revision;
        if (mark != superseded.end()) {
            first = mark->second;
        } else if (cluster != clusters.end() &&
                   cluster->second.cluster.revision == placement.revision) {
            first = whole_revision(cluster->second);
        }
        for (auto it = superseded.lower_bound({placement.cluster, first});
             it != superseded.end() && it->first <= last; ++it)
            referred.push_back(it->first);
    }
    return referred;
}

}  // namespace psfm
