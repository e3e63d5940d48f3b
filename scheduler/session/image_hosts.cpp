// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/image_hosts.h"

#include <algorithm>
#include <iterator>

namespace psfm {

void ImageHosts::belongs_to(ImageId image, ClusterId own) {
    if (index_of(image) >= own_.size()) {
        own_.resize(index_of(image) + 1);
        host_.resize(own_.size());
    }
    own_[index_of(image)] = own;
}

void ImageHosts::move_to(ImageId image, std::optional<ClusterId> host) {
    std::optional<ClusterId>& known = host_[index_of(image)];
    if (known) {
        const auto left = guests_.find(*known);
        std::erase(left->second, image);
        if (left->second.empty()) guests_.erase(left);
    }
    known = host;
    if (!host) return;
    std::vector<ImageId>& guests = guests_[*host];
    guests.insert(std::ranges::lower_bound(guests, image), image);
}

void ImageHosts::set_host(ImageId image, std::optional<ClusterId> host) {
    move_to(image, host);
    home_of_adopted_.erase(image);
}

void ImageHosts::adopt(ImageId image, ClusterId host) {
    move_to(image, host);
    home_of_adopted_[image] = own(image);
}

ClusterId ImageHosts::own(ImageId image) const {
    return own_[index_of(image)];
}

std::optional<ClusterId> ImageHosts::host(ImageId image) const {
    return host_[index_of(image)];
}

bool ImageHosts::is_at_home(ImageId image) const {
    const auto home = home_of_adopted_.find(image);
    return home != home_of_adopted_.end() && home->second == own(image);
}

std::span<const ImageId> ImageHosts::guests_of(ClusterId cluster) const {
    const auto guests = guests_.find(cluster);
    if (guests == guests_.end()) return {};
    return guests->second;
}

std::vector<ImageId> ImageHosts::adopted_by(ClusterId cluster) const {
    std::vector<ImageId> adopted;
    std::ranges::copy_if(guests_of(cluster), std::back_inserter(adopted),
                         [&](ImageId image) { return is_adopted(image); });
    return adopted;
}

}  // namespace psfm
