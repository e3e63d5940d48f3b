// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/apply_relabelling.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

namespace psfm {
namespace {

/// Images that are together before and after.
struct Part {
    std::vector<ImageId> images;  ///< ascending
    std::optional<ClusterId> former;
};

/// One group of the new grouping.
struct Group {
    std::vector<Part> parts;
    std::optional<ClusterId> id;

    ImageId first_image() const {
        ImageId first = parts.front().images.front();
        for (const Part& part : parts) first = std::min(first, part.images.front());
        return first;
    }
};

using Groups = std::map<ClusterId, Group>;  // by label

/// Takes the clusters that change out of the state.
Groups collect_groups(ClusteringState& state, const Relabelling& relabelling) {
    std::map<std::pair<ClusterId, std::optional<ClusterId>>, std::vector<ImageId>> parts;
    std::map<ClusterId, bool> sources;
    for (const ImageId image : relabelling.arrived) {
        parts[{state.cluster_of[index_of(image)], std::nullopt}].push_back(image);
    }
    for (const auto& [image, former] : relabelling.former) {
        parts[{state.cluster_of[index_of(image)], former}].push_back(image);
        sources[former] = true;
    }
    Groups groups;
    for (auto& [key, images] : parts) {
        // A cluster that only gains members takes part as well.
        if (state.members.contains(key.first)) sources[key.first] = true;
        std::ranges::sort(images);
        groups[key.first].parts.push_back({std::move(images), key.second});
    }
    for (const auto& [cluster, unused] : sources) {
        auto node = state.members.extract(cluster);
        std::vector<ImageId> stayed = std::move(node.mapped());
        std::erase_if(stayed, [&](ImageId i) { return state.cluster_of[index_of(i)] != cluster; });
        if (!stayed.empty()) groups[cluster].parts.push_back({std::move(stayed), cluster});
    }
    return groups;
}

void name_groups(Groups& groups, ClusterId& next_id) {
    // Each former cluster stands for the group that holds its largest part, …
    struct Claim {
        const Part* part = nullptr;
        Group* group = nullptr;
    };
    std::map<ClusterId, Claim> claims;
    for (auto& [label, group] : groups) {
        for (const Part& part : group.parts) {
            if (!part.former) continue;
            Claim& claim = claims[*part.former];
            const bool better = claim.part == nullptr ||
                                part.images.size() > claim.part->images.size() ||
                                (part.images.size() == claim.part->images.size() &&
                                 part.images.front() < claim.part->images.front());
            if (better) claim = {&part, &group};
        }
    }
    // … and the strongest claim to a group names it; ascending ids, so that the smallest wins ties.
    std::map<const Group*, std::size_t> strength;
    for (const auto& [former, claim] : claims) {
        std::size_t& best = strength[claim.group];
        if (claim.part->images.size() > best) {
            best = claim.part->images.size();
            claim.group->id = former;
        }
    }
    std::map<ImageId, Group*> unnamed;
    for (auto& [label, group] : groups) {
        if (!group.id) unnamed[group.first_image()] = &group;
    }
    for (const auto& [first, group] : unnamed) {
        group->id = next_id;
        next_id = static_cast<ClusterId>(index_of(next_id) + 1);
    }
}

std::vector<ImageId> join_parts(std::vector<Part>& parts) {
    std::ranges::sort(parts, std::ranges::greater{}, [](const Part& p) { return p.images.size(); });
    std::vector<ImageId> members = std::move(parts.front().images);
    const auto largest = static_cast<std::ptrdiff_t>(members.size());
    for (std::size_t p = 1; p < parts.size(); ++p) {
        members.insert(members.end(), parts[p].images.begin(), parts[p].images.end());
    }
    std::sort(members.begin() + largest, members.end());
    std::inplace_merge(members.begin(), members.begin() + largest, members.end());
    return members;
}

}  // namespace

ClusteringEdit apply_relabelling(ClusteringState& state, const Relabelling& relabelling) {
    Groups groups = collect_groups(state, relabelling);
    name_groups(groups, state.next_id);
    ClusteringEdit edit;
    std::map<ClusterId, bool> survives;
    for (auto& [label, group] : groups) {
        for (const Part& part : group.parts) {
            if (part.former) survives.try_emplace(*part.former, false);
            if (part.former && *part.former != *group.id) {
                edit.moved.push_back({*part.former, *group.id, part.images});
            }
        }
    }
    for (auto& [label, group] : groups) {
        survives[*group.id] = true;
        std::vector<ImageId> members = join_parts(group.parts);
        if (*group.id != label) {
            for (const ImageId image : members) state.cluster_of[index_of(image)] = *group.id;
        }
        edit.changed.push_back({*group.id, members});
        state.members.emplace(*group.id, std::move(members));
    }
    for (const auto& [cluster, alive] : survives) {
        if (!alive) edit.removed.push_back(cluster);
    }
    std::ranges::sort(edit.changed, {}, &ClusterMembers::id);
    std::ranges::sort(edit.moved, {},
                      [](const MovedMembers& m) { return std::pair(m.from, m.to); });
    return edit;
}

}  // namespace psfm
