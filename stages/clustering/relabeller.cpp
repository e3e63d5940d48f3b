// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/relabeller.h"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include "graph/sorted_unique.h"

namespace psfm {

Relabeller::Relabeller(ClusteringState& state, std::size_t graph_size,
                       const ClusteringOptions& options)
    : state_(state), options_(options), former_size_(state.size()), next_label_(state.next_id) {
    for (std::size_t image = former_size_; image < graph_size; ++image) {
        const ClusterId label = fresh_label();
        state_.cluster_of.push_back(label);
        relabelling_.arrived.push_back(static_cast<ImageId>(image));
        gained_[label] = {relabelling_.arrived.back()};
        sizes_[label] = 1;
    }
}

void Relabeller::join(ImageId x, ImageId y) {
    ClusterId into = state_.cluster_of[index_of(x)];
    ClusterId from = state_.cluster_of[index_of(y)];
    if (into == from || !may_join(size_of(into), size_of(from), options_)) return;
    if (std::tuple(size_of(into), from) < std::tuple(size_of(from), into)) std::swap(into, from);
    const std::vector<ImageId> images = images_of(from);
    for (const ImageId image : images) relabel(image, into);
    sizes_[into] = size_of(into) + images.size();
    sizes_[from] = 0;
    gained_.erase(from);
    std::vector<ImageId>& gained = gained_[into];
    gained.insert(gained.end(), images.begin(), images.end());
}

ClusterId Relabeller::split_off(const std::vector<ImageId>& part) {
    const ClusterId from = state_.cluster_of[index_of(part.front())];
    const ClusterId label = fresh_label();
    for (const ImageId image : part) relabel(image, label);
    sizes_[from] = size_of(from) - part.size();
    sizes_[label] = part.size();
    gained_[label] = part;
    return label;
}

std::vector<ImageId> Relabeller::images_of(ClusterId label) const {
    std::vector<ImageId> images;
    const auto take = [&](const std::map<ClusterId, std::vector<ImageId>>& groups) {
        const auto found = groups.find(label);
        if (found == groups.end()) return;
        std::ranges::copy_if(found->second, std::back_inserter(images), [&](ImageId image) {
            return state_.cluster_of[index_of(image)] == label;
        });
    };
    take(state_.members);
    take(gained_);
    // What left a group and came back is in both.
    sort_unique(images);
    return images;
}

Relabelling Relabeller::take() {
    std::erase_if(relabelling_.former, [&](const auto& entry) {
        return state_.cluster_of[index_of(entry.first)] == entry.second;
    });
    return std::move(relabelling_);
}

ClusterId Relabeller::fresh_label() {
    return std::exchange(next_label_, static_cast<ClusterId>(index_of(next_label_) + 1));
}

std::size_t Relabeller::size_of(ClusterId label) const {
    if (const auto changed = sizes_.find(label); changed != sizes_.end()) return changed->second;
    return state_.members.at(label).size();
}

void Relabeller::relabel(ImageId image, ClusterId label) {
    ClusterId& current = state_.cluster_of[index_of(image)];
    if (index_of(image) < former_size_) relabelling_.former.try_emplace(image, current);
    current = label;
}

}  // namespace psfm
