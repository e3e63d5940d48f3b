// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/find_split_parts.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "stages/algorithms/math/union_find.h"

namespace psfm {
namespace {

/// One breadth-first search; after meetings, several of them together.
struct Search {
    std::vector<ImageId> found;
    std::vector<ImageId> frontier;  ///< those before `next` have been expanded
    std::size_t next = 0;
};

class SeedSearches {
  public:
    SeedSearches(ClusteringState& state, std::span<const ImageId> seeds)
        : links_(state.links),
          cluster_of_(state.cluster_of),
          stamp_(state.workspace.stamp),
          searches_(seeds.size()) {
        std::uint32_t& last = state.workspace.last_stamp;
        if (seeds.size() >= std::numeric_limits<std::uint32_t>::max() - last) {
            std::ranges::fill(stamp_, 0U);
            last = 0;
        }
        base_ = last + 1;
        last += static_cast<std::uint32_t>(seeds.size());
        for (std::size_t s = 0; s < seeds.size(); ++s) {
            parts_.add();
            if (stamp_[index_of(seeds[s])] >= base_) continue;  // named twice
            reach(seeds[s], s);
            active_.push_back(s);
        }
    }

    std::vector<std::vector<ImageId>> run() {
        std::vector<std::vector<ImageId>> parts;
        alive_ = active_.size();
        while (alive_ > 1) {
            for (std::size_t k = 0; k < active_.size() && alive_ > 1; ++k) {
                if (parts_.root_of(active_[k]) != active_[k]) continue;  // absorbed in this round
                const std::size_t root = expand_next(active_[k]);
                Search& search = searches_[root];
                if (alive_ > 1 && search.next == search.frontier.size()) {
                    parts.push_back(std::move(search.found));
                    finished_.push_back(root);
                    --alive_;
                }
            }
            std::erase_if(active_, [this](std::size_t s) {
                return parts_.root_of(s) != s || std::ranges::find(finished_, s) != finished_.end();
            });
        }
        return parts;
    }

  private:
    void reach(ImageId image, std::size_t search) {
        stamp_[index_of(image)] = base_ + static_cast<std::uint32_t>(search);
        searches_[search].found.push_back(image);
        searches_[search].frontier.push_back(image);
    }

    /// @return the search that holds everything afterwards
    std::size_t unite(std::size_t a, std::size_t b) {
        if (searches_[a].found.size() < searches_[b].found.size()) std::swap(a, b);
        Search& kept = searches_[a];
        Search gone = std::exchange(searches_[b], {});
        kept.found.insert(kept.found.end(), gone.found.begin(), gone.found.end());
        kept.frontier.insert(kept.frontier.end(),
                             gone.frontier.begin() + static_cast<std::ptrdiff_t>(gone.next),
                             gone.frontier.end());
        parts_.attach(b, a);
        --alive_;
        return a;
    }

    /// REQUIRES: something is left to expand.
    std::size_t expand_next(std::size_t root) {
        const ImageId image = searches_[root].frontier[searches_[root].next++];
        for (const ImageId neighbor : links_[index_of(image)]) {
            if (cluster_of_[index_of(neighbor)] != cluster_of_[index_of(image)]) continue;
            const std::uint32_t stamp = stamp_[index_of(neighbor)];
            if (stamp < base_) {
                reach(neighbor, root);
                continue;
            }
            const std::size_t other = parts_.root_of(stamp - base_);
            if (other == root) continue;
            root = unite(root, other);
            if (alive_ == 1) break;
        }
        return root;
    }

    const std::vector<std::vector<ImageId>>& links_;
    const std::vector<ClusterId>& cluster_of_;
    std::vector<std::uint32_t>& stamp_;
    std::uint32_t base_ = 0;
    std::vector<Search> searches_;
    UnionFind<std::size_t> parts_;
    std::vector<std::size_t>
        active_;  ///< roots still searching, ascending; stale entries between rounds
    std::vector<std::size_t> finished_;
    std::size_t alive_ = 0;
};

}  // namespace

std::vector<std::vector<ImageId>> find_split_parts(ClusteringState& state,
                                                   std::span<const ImageId> seeds) {
    return SeedSearches(state, seeds).run();
}

}  // namespace psfm
