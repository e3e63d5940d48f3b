// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Two rooms of four photographs each, matched within a room only: two clusters. The scheduler is
// asked for its options, so that every library is linked.
#include <cstdio>

#include "graph/view_graph.h"
#include "scheduler/session/session_config.h"
#include "stages/clustering/batch_clusters.h"

int main() {
    using psfm::ImageId;
    const auto options = psfm::stage_options(psfm::SessionConfig{});
    if (!options.ok()) {
        std::printf("%s\n", options.error().message.c_str());
        return 1;
    }
    constexpr std::uint32_t kImages = 8;
    psfm::ViewGraph graph;
    for (std::uint32_t image = 0; image < kImages; ++image) graph.add_node();
    for (std::uint32_t a = 0; a < kImages; ++a) {
        for (std::uint32_t b = a + 1; b < kImages; ++b) {
            if (a / 4 == b / 4) graph.add_edge(ImageId{a}, ImageId{b}, 100.0);
        }
    }
    const auto clusters = psfm::batch_clusters(graph, options->clustering);
    std::printf("%zu clusters\n", clusters.size());
    return clusters.size() == 2 ? 0 : 1;
}
