// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <numeric>
#include <vector>

namespace psfm {

/// Disjoint sets of 0 … n-1, each with one of its numbers, its root, that stands for it. Not
/// thread-safe: asking for a root shortens the way to it.
template <std::unsigned_integral Index = std::uint32_t>
class UnionFind {
  public:
    UnionFind() = default;
    /// Every number is a set of its own.
    explicit UnionFind(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), Index{0});
    }

    std::size_t size() const { return parent_.size(); }
    /// One more number, a set of its own. @return the number
    Index add() {
        parent_.push_back(static_cast<Index>(parent_.size()));
        return parent_.back();
    }
    Index root_of(Index number) {
        while (parent_[number] != number) number = parent_[number] = parent_[parent_[number]];
        return number;
    }
    /// Makes one set of two; the smaller root stands for it. Whoever only joins has the smallest
    /// number of a set as its root. @return whether they were two
    bool join(Index a, Index b) {
        a = root_of(a);
        b = root_of(b);
        if (a == b) return false;
        parent_[std::max(a, b)] = std::min(a, b);
        return true;
    }
    /// Makes one set of two of which `root` stands for one; the other's root stands for both.
    void attach(Index root, Index to) { parent_[root] = root_of(to); }

  private:
    std::vector<Index> parent_;
};

}  // namespace psfm
