// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Which cluster places an image: its own, or the host that tries it as a guest.
#include <algorithm>
#include <iterator>
#include <set>

#include "scheduler/session/cluster_table.h"

namespace psfm {

void ClusterTable::edges_changed(std::span<const ImageId> images) {
    for (const ImageId image : images) {
        const auto placing = entries_.find(of(image).id);
        ++placing->second.published.placing_changes;
    }
}

void ClusterTable::count_placing_changes(ImageId image) {
    std::set<ClusterId> clusters{hosts_.own(image)};
    if (const auto host = hosts_.host(image)) clusters.insert(*host);
    for (const ClusterId id : clusters) {
        const auto entry = entries_.find(id);
        if (entry != entries_.end()) ++entry->second.published.placing_changes;
    }
}

std::vector<ClusterId> ClusterTable::set_hosts(
    std::span<const std::pair<ImageId, std::optional<ClusterId>>> hosts) {
    std::set<ClusterId> changed;
    for (const auto& [image, host] : hosts) {
        const bool was_adopted = hosts_.is_adopted(image);
        const std::optional<ClusterId> left = hosts_.host(image);
        if (left == host && !was_adopted) continue;
        count_placing_changes(image);
        hosts_.set_host(image, host);
        count_placing_changes(image);
        if (left && entries_.contains(*left)) changed.insert(*left);
        if (host) {
            changed.insert(*host);
        } else if (was_adopted) {
            changed.insert(hosts_.own(image));
        }
    }
    std::vector<ClusterId> dirty(changed.begin(), changed.end());
    make_dirty(dirty);
    return dirty;
}

void ClusterTable::adopt(ImageId image, ClusterId host) {
    count_placing_changes(image);
    hosts_.adopt(image, host);
    count_placing_changes(image);
    make_dirty(std::span(&host, 1));
}

bool ClusterTable::stays_adopted(ImageId image) const {
    if (!hosts_.is_at_home(image)) return false;
    const auto host = entries_.find(hosts_.placing(image));
    if (host == entries_.end() || !makes_model(host->second.membership.members.size()))
        return false;
    const ClusterEntry& entry = host->second;
    const bool is_placed = entry.published.model && entry.published.model->find(image) != nullptr;
    return is_placed || entry.phase != ClusterPhase::kClean;
}

std::vector<ImageId> ClusterTable::images_of(const ClusterEntry& entry) const {
    std::vector<ImageId> images;
    std::ranges::copy_if(entry.membership.members, std::back_inserter(images),
                         [&](ImageId image) { return !hosts_.host(image); });
    const auto members = static_cast<std::ptrdiff_t>(images.size());
    std::ranges::copy(hosts_.guests_of(entry.id), std::back_inserter(images));
    std::inplace_merge(images.begin(), images.begin() + members, images.end());
    return images;
}

std::vector<ImageId> ClusterTable::unplaced_of(const ClusterEntry& entry) const {
    std::vector<ImageId> images = images_of(entry);
    if (!entry.published.model) return images;
    auto placed = entry.published.model->images.begin();  // both ascend
    std::erase_if(images, [&](ImageId image) {
        while (placed != entry.published.model->images.end() && placed->image < image) ++placed;
        return placed != entry.published.model->images.end() && placed->image == image;
    });
    return images;
}

}  // namespace psfm
