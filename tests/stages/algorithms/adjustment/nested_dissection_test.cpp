// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/adjustment/nested_dissection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

void connect(NeighborLists& graph, std::uint32_t a, std::uint32_t b) {
    graph[a].push_back(b);
    graph[b].push_back(a);
}

/// Crossing streets of `blocks` by `blocks` blocks; in each, images see their next four.
NeighborLists town(std::uint32_t blocks, std::uint32_t images_a_side, std::uint64_t seed) {
    const std::uint32_t length = blocks * images_a_side;
    const std::uint32_t streets = 2 * (blocks + 1);
    std::vector<std::uint32_t> number(std::size_t{streets} * length);
    std::iota(number.begin(), number.end(), 0U);
    synthetic::Rng rng(seed);
    rng.shuffle(number);
    NeighborLists graph(number.size());
    const auto at = [&](std::uint32_t street, std::uint32_t way) {
        return number[std::size_t{street} * length + way];
    };
    for (std::uint32_t street = 0; street < streets; ++street) {
        for (std::uint32_t way = 0; way < length; ++way) {
            for (std::uint32_t next = way + 1; next < std::min(way + 5, length); ++next)
                connect(graph, at(street, way), at(street, next));
        }
    }
    for (std::uint32_t along = 0; along <= blocks; ++along) {
        for (std::uint32_t across = 0; across <= blocks; ++across) {
            const std::uint32_t way = std::min(across * images_a_side, length - 1);
            const std::uint32_t other = std::min(along * images_a_side, length - 1);
            connect(graph, at(along, way), at(blocks + 1 + across, other));
        }
    }
    return graph;
}

/// Entries below the diagonal of the Cholesky factor, in blocks of `width` successive nodes.
std::size_t fill_of(const NeighborLists& graph, const std::vector<std::uint32_t>& order,
                    std::uint32_t width) {
    std::vector<std::uint32_t> block(order.size());
    for (std::uint32_t k = 0; k < order.size(); ++k) block[order[k]] = k / width;
    std::vector<std::set<std::uint32_t>> below(order.size() / width + 1);
    for (std::uint32_t node = 0; node < graph.size(); ++node) {
        for (const std::uint32_t other : graph[node]) {
            if (block[other] > block[node]) below[block[node]].insert(block[other]);
        }
    }
    std::size_t fill = 0;
    for (std::size_t column = 0; column < below.size(); ++column) {
        fill += below[column].size();
        for (const std::uint32_t next : below[column]) {
            std::ranges::copy_if(below[column], std::inserter(below[next], below[next].end()),
                                 [&](std::uint32_t row) { return row > next; });
        }
    }
    return fill * width * width;
}

std::vector<std::uint32_t> numbers(std::size_t count) {
    std::vector<std::uint32_t> all(count);
    std::iota(all.begin(), all.end(), 0U);
    return all;
}

TEST(NestedDissection, NamesEachNodeOnce) {
    synthetic::Rng rng(1);
    for (int round = 0; round < 200; ++round) {
        NeighborLists graph(1 + rng.below(150));
        for (std::size_t edges = rng.below(3 * graph.size()); edges > 0; --edges) {
            const auto a = static_cast<std::uint32_t>(rng.below(graph.size()));
            const auto b = static_cast<std::uint32_t>(rng.below(graph.size()));
            if (a != b) connect(graph, a, b);
        }
        std::vector<std::uint32_t> order = nested_dissection(graph);
        std::ranges::sort(order);
        ASSERT_EQ(order, numbers(graph.size())) << round;
    }
    EXPECT_TRUE(nested_dissection({}).empty());
}

/// As the 1.5th power of the town's size, in wide blocks.
TEST(NestedDissection, FillGrowsWithATownsArea) {
    const NeighborLists small = town(4, 40, 2);
    const NeighborLists large = town(8, 40, 3);
    const double images = static_cast<double>(large.size()) / static_cast<double>(small.size());
    const double fill = static_cast<double>(fill_of(large, nested_dissection(large), 32)) /
                        static_cast<double>(fill_of(small, nested_dissection(small), 32));
    EXPECT_LT(fill, 1.1 * std::pow(images, 1.5));
    EXPECT_LT(5 * fill_of(large, nested_dissection(large), 32),
              fill_of(large, numbers(large.size()), 32));
}

/// Everything sees everything: no order is better than another.
TEST(NestedDissection, OfADenseGraphIsAnyOrder) {
    NeighborLists graph(100);
    for (std::uint32_t a = 0; a < graph.size(); ++a) {
        for (std::uint32_t b = 0; b < a; ++b) connect(graph, a, b);
    }
    std::vector<std::uint32_t> order = nested_dissection(graph);
    std::ranges::sort(order);
    EXPECT_EQ(order, numbers(graph.size()));
}

}  // namespace
}  // namespace psfm
