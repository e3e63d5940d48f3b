// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/adjustment/nested_dissection.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace psfm {
namespace {

/// Guard: parts of so few nodes are not divided further. Ours: from 16 to 128 the fill is the same.
constexpr std::size_t kSmallPart = 32;
/// Guard: separators that leave more than this part of the nodes on one side count for worse. Ours:
/// the fill depends on it, not the solution.
constexpr double kBalanced = 0.7;

constexpr std::uint32_t kNotReached = std::numeric_limits<std::uint32_t>::max();

using Nodes = std::vector<std::uint32_t>;

class Dissection {
  public:
    explicit Dissection(const NeighborLists& neighbors)
        : neighbors_(neighbors), part_of_(neighbors.size(), 0), level_of_(neighbors.size(), 0) {}

    Nodes order() && {
        Nodes all(neighbors_.size());
        std::iota(all.begin(), all.end(), 0U);
        open_.push_back(std::move(all));
        while (!open_.empty()) {
            const Nodes part = std::move(open_.back());
            open_.pop_back();
            if (!part.empty()) divide(part);
        }
        std::ranges::reverse(last_first_);
        return std::move(last_first_);
    }

  private:
    /// A connected part is eliminated as it is, or after the parts that a separator leaves of it.
    void divide(const Nodes& part) {
        ++parts_;
        for (const std::uint32_t node : part) part_of_[node] = parts_;
        Nodes reached = search(part, part.front());
        if (reached.size() < part.size()) {
            Nodes unreached;
            std::ranges::copy_if(part, std::back_inserter(unreached), [&](std::uint32_t node) {
                return level_of_[node] == kNotReached;
            });
            open_.push_back(std::move(unreached));
            open_.push_back(std::move(reached));
            return;
        }
        if (part.size() > kSmallPart) {
            // Twice from the farthest node: a long scene is searched from one of its ends.
            for (int repeat = 0; repeat < 2; ++repeat) reached = search(part, reached.back());
            if (const auto level = separating_level(reached)) {
                separate(reached, *level);
                return;
            }
        }
        std::ranges::copy(reached, std::back_inserter(last_first_));
    }

    /// Breadth first, within a part; sets the levels of its nodes. @return nodes by level
    Nodes search(const Nodes& part, std::uint32_t root) {
        for (const std::uint32_t node : part) level_of_[node] = kNotReached;
        Nodes reached{root};
        level_of_[root] = 0;
        for (std::size_t k = 0; k < reached.size(); ++k) {
            for (const std::uint32_t next : neighbors_[reached[k]]) {
                if (part_of_[next] != parts_ || level_of_[next] != kNotReached) continue;
                level_of_[next] = level_of_[reached[k]] + 1;
                reached.push_back(next);
            }
        }
        return reached;
    }

    /// The smallest level with nodes on both sides of it; nothing when there is none.
    std::optional<std::uint32_t> separating_level(const Nodes& by_level) const {
        std::vector<std::size_t> sizes(level_of_[by_level.back()] + 1, 0);
        for (const std::uint32_t node : by_level) ++sizes[level_of_[node]];
        std::optional<std::uint32_t> best;
        double least = std::numeric_limits<double>::infinity();
        std::size_t before = sizes.front();
        for (std::uint32_t level = 1; level + 1 < sizes.size(); ++level) {
            const std::size_t after = by_level.size() - before - sizes[level];
            const double larger_side =
                static_cast<double>(std::max(before, after)) / static_cast<double>(by_level.size());
            constexpr double kPenalty = 20.0;  // Guard: as kBalanced; ours
            const double cost = static_cast<double>(sizes[level]) *
                                (1.0 + kPenalty * std::max(0.0, larger_side - kBalanced));
            if (cost < least) {
                least = cost;
                best = level;
            }
            before += sizes[level];
        }
        return best;
    }

    /// Of the level, those nodes that have neighbours beyond it are eliminated last.
    void separate(const Nodes& by_level, std::uint32_t level) {
        Nodes near;
        Nodes far;
        for (const std::uint32_t node : by_level) {
            if (level_of_[node] > level) {
                far.push_back(node);
            } else if (level_of_[node] == level && reaches_beyond(node)) {
                last_first_.push_back(node);
            } else {
                near.push_back(node);
            }
        }
        open_.push_back(std::move(near));
        open_.push_back(std::move(far));
    }

    bool reaches_beyond(std::uint32_t node) const {
        return std::ranges::any_of(neighbors_[node], [&](std::uint32_t next) {
            return part_of_[next] == parts_ && level_of_[next] == level_of_[node] + 1;
        });
    }

    const NeighborLists& neighbors_;
    std::uint32_t parts_ = 0;  ///< so far; the number of the one that is being divided
    std::vector<std::uint32_t> part_of_;
    std::vector<std::uint32_t> level_of_;  ///< by the last search of the node's part
    std::vector<Nodes> open_;              ///< parts to divide, the next one last
    Nodes last_first_;                     ///< the order of elimination, from its end
};

}  // namespace

std::vector<std::uint32_t> nested_dissection(const NeighborLists& neighbors) {
    return Dissection(neighbors).order();
}

}  // namespace psfm
