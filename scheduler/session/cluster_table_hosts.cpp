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

std::optional<ClusterId> ClusterTable::host_of(ImageId image) const {
    return index_of(image) < host_of_.size() ? host_of_[index_of(image)] : std::nullopt;
}

void ClusterTable::set_host(ImageId image, std::optional<ClusterId> host) {
    if (index_of(image) >= host_of_.size()) host_of_.resize(index_of(image) + 1);
    std::optional<ClusterId>& known = host_of_[index_of(image)];
    const std::optional<ClusterId> own = index_of(image) < cluster_of_.size()
                                             ? std::optional(cluster_of_[index_of(image)])
                                             : std::nullopt;
    for (const std::optional<ClusterId>& id : {known, host, own}) {
        const auto entry = id ? entries_.find(*id) : entries_.end();
        if (entry != entries_.end()) ++entry->second.published.placing_changes;
    }
    known = host;
}

std::optional<ClusterId> ClusterTable::take_from_host(ImageId guest) {
    const std::optional<ClusterId> host = host_of(guest);
    if (!host) return std::nullopt;
    set_host(guest, std::nullopt);
    if (const auto left = entries_.find(*host); left != entries_.end())
        std::erase(left->second.membership.guests, guest);
    return host;
}

void ClusterTable::give_to_host(ImageId guest, ClusterId host) {
    set_host(guest, host);
    std::vector<ImageId>& guests = entries_.at(host).membership.guests;
    guests.insert(std::ranges::lower_bound(guests, guest), guest);
}

std::vector<ClusterId> ClusterTable::set_hosts(
    std::span<const std::pair<ImageId, std::optional<ClusterId>>> hosts) {
    std::set<ClusterId> changed;
    for (const auto& [image, host] : hosts) {
        const bool was_adopted = home_of_adopted_.erase(image) > 0;
        if (host_of(image) == host && !was_adopted) continue;
        if (const auto left = take_from_host(image); left && entries_.contains(*left))
            changed.insert(*left);
        if (host) {
            give_to_host(image, *host);
            changed.insert(*host);
        } else if (was_adopted) {
            changed.insert(cluster_of_[index_of(image)]);
        }
    }
    std::vector<ClusterId> dirty(changed.begin(), changed.end());
    make_dirty(dirty);
    return dirty;
}

void ClusterTable::adopt(ImageId image, ClusterId host) {
    take_from_host(image);
    give_to_host(image, host);
    home_of_adopted_[image] = cluster_of_[index_of(image)];
    make_dirty(std::span(&host, 1));
}

bool ClusterTable::stays_adopted(ImageId image) const {
    const auto home = home_of_adopted_.find(image);
    if (home == home_of_adopted_.end() || cluster_of_[index_of(image)] != home->second)
        return false;
    const auto host = entries_.find(*host_of(image));
    if (host == entries_.end() || !makes_model(host->second.membership.members.size()))
        return false;
    const ClusterEntry& entry = host->second;
    const bool is_placed = entry.published.model && entry.published.model->find(image) != nullptr;
    return is_placed || entry.phase != ClusterPhase::kClean;
}

std::vector<ImageId> ClusterTable::adopted_by(const ClusterEntry& entry) const {
    std::vector<ImageId> adopted;
    std::ranges::copy_if(entry.membership.guests, std::back_inserter(adopted),
                         [&](ImageId image) { return is_adopted(image); });
    return adopted;
}

std::vector<ImageId> ClusterTable::guests_of(std::span<const ClusterId> clusters) const {
    std::vector<ImageId> guests;
    for (const ClusterId id : clusters) {
        const auto entry = entries_.find(id);
        const auto orphans = orphans_.find(id);
        if (entry != entries_.end())
            std::ranges::copy(entry->second.membership.guests, std::back_inserter(guests));
        if (orphans != orphans_.end())
            std::ranges::copy(orphans->second, std::back_inserter(guests));
    }
    std::ranges::sort(guests);
    return guests;
}

const ClusterEntry& ClusterTable::of(ImageId image) const {
    return entries_.at(host_of(image).value_or(cluster_of_[index_of(image)]));
}

std::vector<ImageId> ClusterTable::images_of(const ClusterEntry& entry) const {
    std::vector<ImageId> images;
    std::ranges::copy_if(entry.membership.members, std::back_inserter(images),
                         [&](ImageId image) { return !host_of(image); });
    const auto members = static_cast<std::ptrdiff_t>(images.size());
    images.insert(images.end(), entry.membership.guests.begin(), entry.membership.guests.end());
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
