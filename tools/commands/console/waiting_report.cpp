// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/waiting_report.h"

#include <algorithm>
#include <map>

namespace psfm {
namespace {

const char* cause(WaitReason reason) {
    switch (reason) {
        case WaitReason::kTooFewFeatures:
            return "too few features: the photographs are blurred, dark, tiny or of plain "
                   "surfaces; take sharp ones of something with texture";
        case WaitReason::kTooFewMatches:
            return "no overlap: hardly a photograph has enough in common with another; take them "
                   "in smaller steps, so that each thing is in three of them";
        case WaitReason::kStandsStill:
            return "static background: what the photographs have in common stands still in them (a "
                   "watermark, a date, a hood, what is behind a turntable); crop it away, or take "
                   "the object before a plain background or by walking around it";
        case WaitReason::kNoParallax:
            return "no parallax: the camera only turned or stood still, and no depth follows from "
                   "that; walk between photographs";
        case WaitReason::kClusterTooSmall:
            return "too little overlap: the photographs hang together in groups that are too small "
                   "for a model; take more between them";
        case WaitReason::kNoSeed:
        case WaitReason::kRegistrationFailed:
            return "no two photographs have enough points in common at a sufficient angle; take "
                   "more of them, a step apart";
        case WaitReason::kLookAlikes:
            return "look-alikes: the photographs could show different things that look alike; take "
                   "more between them, and of what stands beside";
        case WaitReason::kNone:
        case WaitReason::kSolving:
            break;
    }
    return "they have not been looked at to the end; `psfm resume` goes on";
}

}  // namespace

std::string why_nothing_is_placed(std::span<const WaitReason> waiting, const SolvePolicy& policy) {
    std::string line = "nothing could be placed: ";
    if (!policy.makes_model(waiting.size())) {
        return line + "a model takes at least " + std::to_string(policy.mu_min) +
               " photographs of one place, and there " + (waiting.size() == 1 ? "is " : "are ") +
               std::to_string(waiting.size()) + "; add more";
    }
    std::map<WaitReason, std::size_t> counts;
    for (const WaitReason reason : waiting) ++counts[reason];
    const auto most =
        std::ranges::max_element(counts, {}, [](const auto& reason) { return reason.second; });
    return line + cause(most->first);
}

}  // namespace psfm
