// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "scheduler/session_state.h"

namespace psfm {

std::vector<std::pair<ImageId, WaitReason>> waiting_images(const SessionState& state,
                                                           std::uint32_t mu_min) {
    std::vector<std::pair<ImageId, WaitReason>> waiting;
    for (const auto& [id, entry] : state.clusters.entries()) {
        for (const ImageId image : state.clusters.unplaced_of(entry)) {
            if (state.is_removed(image)) continue;
            WaitReason reason = WaitReason::kSolving;
            if (state.view_graph.edges(image).empty()) {
                reason = WaitReason::kTooFewMatches;
            } else if (entry.members.size() < mu_min) {
                reason = WaitReason::kClusterTooSmall;
            } else if (entry.phase == ClusterPhase::kClean) {
                reason = entry.model && !entry.model->empty() ? WaitReason::kRegistrationFailed
                                                              : WaitReason::kNoSeed;
            }
            waiting.emplace_back(image, reason);
        }
    }
    for (std::uint32_t image = state.verified; image < state.images.size(); ++image) {
        const auto id = static_cast<ImageId>(image);
        if (!state.is_removed(id)) waiting.emplace_back(id, WaitReason::kSolving);
    }
    std::ranges::sort(waiting);
    return waiting;
}

}  // namespace psfm
