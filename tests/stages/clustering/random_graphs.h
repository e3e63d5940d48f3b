// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "graph/view_graph.h"
#include "tests/synthetic/rng.h"

namespace psfm::test {

/// Symmetric weights between images, 0: no edge. What an order of arrival is chosen for.
struct WeightTable {
    std::size_t size = 0;
    std::vector<double> values;

    explicit WeightTable(std::size_t n) : size(n), values(n * n, 0.0) {}
    double at(std::size_t i, std::size_t j) const { return values[i * size + j]; }
    void set(std::size_t i, std::size_t j, double weight) {
        values[i * size + j] = values[j * size + i] = weight;
    }
};

/// Weights of different make: sparse, dense, ring-like, and blobs with weak ties; small whole
/// numbers make distances that fall on eta, fractions make sums that round.
inline WeightTable random_weights(synthetic::Rng& rng) {
    const std::size_t n = 2 + rng.below(29);
    const std::size_t kind = rng.below(4);
    const bool whole = rng.below(2) == 0;
    const double density = rng.uniform(0.03, 0.7);
    WeightTable table(n);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            double chance = density;
            double strength = 1.0;
            const std::size_t step = std::min(j - i, n - (j - i));
            if (kind == 1) chance = step <= 3 ? 0.9 : 0.02;
            if (kind == 2) chance = i % 3 == j % 3 ? 0.9 : 0.05;
            if (kind == 3) strength = 20.0 / (1.0 + static_cast<double>(step));
            if (rng.uniform() >= chance) continue;
            const double weight = rng.uniform(0.1, 10.0) * strength;
            table.set(i, j, whole ? std::ceil(weight) : weight);
        }
    }
    return table;
}

/// Images first … last matched all with all.
inline void connect(WeightTable& table, std::size_t first, std::size_t last, double weight) {
    for (std::size_t a = first; a <= last; ++a) {
        for (std::size_t b = a + 1; b <= last; ++b) table.set(a, b, weight);
    }
}

/// Adds, drops or reweights one to four edges, to whole weights. @return the touched images
inline std::vector<ImageId> change_some_edges(WeightTable& table, synthetic::Rng& rng) {
    std::vector<ImageId> touched;
    for (std::size_t edges = 1 + rng.below(4); edges > 0; --edges) {
        const std::size_t i = rng.below(table.size);
        const std::size_t j = rng.below(table.size);
        if (i == j) continue;
        table.set(i, j, rng.below(2) == 0 ? 0.0 : std::ceil(rng.uniform(0.0, 9.0)));
        touched.push_back(static_cast<ImageId>(i));
        touched.push_back(static_cast<ImageId>(j));
    }
    return touched;
}

inline ViewGraph graph_of(const WeightTable& table) {
    ViewGraph graph;
    for (std::size_t i = 0; i < table.size; ++i) graph.add_node();
    for (std::size_t i = 0; i < table.size; ++i) {
        for (std::size_t j = i + 1; j < table.size; ++j) {
            if (table.at(i, j) > 0.0) {
                graph.add_edge(static_cast<ImageId>(i), static_cast<ImageId>(j), table.at(i, j));
            }
        }
    }
    return graph;
}

/// Adds table row order[graph.size()] as the next image.
/// @return the touched images
inline std::vector<ImageId> add_next(ViewGraph& graph, const WeightTable& table,
                                     const std::vector<std::size_t>& order) {
    const ImageId image = graph.add_node();
    std::vector<ImageId> touched{image};
    for (std::uint32_t k = 0; k < index_of(image); ++k) {
        const double weight = table.at(order[index_of(image)], order[k]);
        if (weight <= 0.0) continue;
        graph.add_edge(image, static_cast<ImageId>(k), weight);
        touched.push_back(static_cast<ImageId>(k));
    }
    return touched;
}

}  // namespace psfm::test
