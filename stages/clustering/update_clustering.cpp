// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/update_clustering.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "stages/clustering/apply_relabelling.h"
#include "stages/clustering/find_split_parts.h"
#include "stages/clustering/update_links.h"

namespace psfm {
namespace {

/// Provisional labels: former clusters by their ids, new groups by unused numbers.
class Relabeller {
  public:
    Relabeller(ClusteringState& state, std::size_t new_size)
        : state_(state), former_size_(state.size()), next_label_(state.next_id) {
        for (std::size_t image = former_size_; image < new_size; ++image) {
            const ClusterId label = fresh_label();
            state_.cluster_of.push_back(label);
            relabelling_.arrived.push_back(static_cast<ImageId>(image));
            joined_[label] = {relabelling_.arrived.back()};
        }
    }

    /// Joins the groups of two images, the smaller one into the larger (ties: into the older
    /// label).
    void join(ImageId x, ImageId y) {
        ClusterId into = state_.cluster_of[index_of(x)];
        ClusterId from = state_.cluster_of[index_of(y)];
        if (into == from) return;
        const auto rank = [&](ClusterId label) {
            return std::pair(-size_of(label), index_of(label));
        };
        if (rank(from) < rank(into)) std::swap(into, from);
        std::vector<ImageId> gained;
        if (const auto found = state_.members.find(from); found != state_.members.end()) {
            gained = found->second;
        }
        if (auto node = joined_.extract(from); !node.empty()) {
            gained.insert(gained.end(), node.mapped().begin(), node.mapped().end());
        }
        for (const ImageId image : gained) relabel(image, into);
        std::vector<ImageId>& all = joined_[into];
        all.insert(all.end(), gained.begin(), gained.end());
    }

    /// REQUIRES: all joins done.
    void split_off(const std::vector<ImageId>& part) {
        const ClusterId label = fresh_label();
        for (const ImageId image : part) relabel(image, label);
    }

    const Relabelling& relabelling() const { return relabelling_; }

  private:
    ClusterId fresh_label() {
        return std::exchange(next_label_, static_cast<ClusterId>(index_of(next_label_) + 1));
    }

    std::ptrdiff_t size_of(ClusterId label) const {
        const auto own = state_.members.find(label);
        const auto more = joined_.find(label);
        return static_cast<std::ptrdiff_t>((own == state_.members.end() ? 0 : own->second.size()) +
                                           (more == joined_.end() ? 0 : more->second.size()));
    }

    void relabel(ImageId image, ClusterId label) {
        ClusterId& current = state_.cluster_of[index_of(image)];
        if (index_of(image) < former_size_) relabelling_.former.try_emplace(image, current);
        current = label;
    }

    ClusteringState& state_;
    std::size_t former_size_;
    ClusterId next_label_;
    std::map<ClusterId, std::vector<ImageId>>
        joined_;  ///< images of a group beyond its label's own
    Relabelling relabelling_;
};

}  // namespace

ClusteringEdit update_clustering(ClusteringState& state, const ViewGraph& graph,
                                 std::span<const ImageId> touched,
                                 const ClusteringOptions& options) {
    assert(graph.size() >= state.size());
    std::vector<ImageId> dirty(touched.begin(), touched.end());
    for (std::size_t image = state.size(); image < graph.size(); ++image) {
        dirty.push_back(static_cast<ImageId>(image));
    }
    std::ranges::sort(dirty);
    dirty.erase(std::unique(dirty.begin(), dirty.end()), dirty.end());

    state.degrees.resize(graph.size());
    state.links.resize(graph.size());
    state.workspace.weight.resize(graph.size());
    state.workspace.stamp.resize(graph.size());
    const LinkChanges changes = update_links(state, graph, dirty, options);

    // Joins first: a new image often takes links away whose ends it connects itself, and then the
    // search for parts ends at once.
    Relabeller relabeller(state, graph.size());
    for (const ImagePair& link : changes.added) relabeller.join(link.first, link.second);
    std::map<ClusterId, std::vector<ImageId>> lost_ends;
    for (const ImagePair& link : changes.removed) {
        std::vector<ImageId>& ends = lost_ends[state.cluster_of[index_of(link.first)]];
        ends.push_back(link.first);
        ends.push_back(link.second);
    }
    for (const auto& [label, ends] : lost_ends) {
        for (const std::vector<ImageId>& part : find_split_parts(state, ends)) {
            relabeller.split_off(part);
        }
    }
    return apply_relabelling(state, relabeller.relabelling());
}

}  // namespace psfm
