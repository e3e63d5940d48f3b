// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/scene.h"

namespace psfm {

const char* describe(WaitReason reason) {
    switch (reason) {
        case WaitReason::kNone:
            return "placed";
        case WaitReason::kTooFewMatches:
            return "too few matches with any other image";
        case WaitReason::kClusterTooSmall:
            return "its cluster has too few images";
        case WaitReason::kNoSeed:
            return "no pair of its cluster can start a reconstruction";
        case WaitReason::kRegistrationFailed:
            return "too few consistent points to place it";
        case WaitReason::kSolving:
            return "its cluster is being solved";
    }
    return "unknown";
}

std::size_t placed_count(const Scene& scene) {
    std::size_t placed = 0;
    for (const auto& cluster : scene.clusters) {
        if (cluster->model) placed += cluster->model->images.size();
    }
    return placed;
}

}  // namespace psfm
