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
        case WaitReason::kNoParallax:
            return "no parallax: the camera only turned between it and the others";
        case WaitReason::kStandsStill:
            return "what it has in common with others stands still in the photograph";
        case WaitReason::kTooFewFeatures:
            return "too few features in it";
        case WaitReason::kLookAlikes:
            return "it could show another thing that looks alike";
    }
    return "unknown";
}

const char* name_of(WaitReason reason) {
    switch (reason) {
        case WaitReason::kNone:
            return "placed";
        case WaitReason::kTooFewMatches:
            return "too_few_matches";
        case WaitReason::kClusterTooSmall:
            return "cluster_too_small";
        case WaitReason::kNoSeed:
            return "no_seed";
        case WaitReason::kRegistrationFailed:
            return "registration_failed";
        case WaitReason::kSolving:
            return "solving";
        case WaitReason::kNoParallax:
            return "no_parallax";
        case WaitReason::kStandsStill:
            return "stands_still";
        case WaitReason::kTooFewFeatures:
            return "too_few_features";
        case WaitReason::kLookAlikes:
            return "look_alikes";
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
