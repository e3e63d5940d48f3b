// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/solve_policy.h"

#include <limits>

namespace psfm {

SolvePolicy paper_policy() {
    // Format: no number of images is above it
    constexpr std::uint32_t kNever = std::numeric_limits<std::uint32_t>::max();
    SolvePolicy policy;
    policy.doubt_up_to = 0;
    policy.large_from = kNever;
    policy.converge_up_to = kNever;
    policy.affordable_up_to = kNever;
    return policy;
}

Result<void> validate(const SolvePolicy& policy) {
    if (policy.mu_min < 2)
        return Error{ErrorCode::kInvalidArgument, "a cluster to be solved has at least 2 images"};
    if (!(policy.full_adjustment.again_when_grown_by > 0))
        return Error{ErrorCode::kInvalidArgument, "eta_grow must be positive"};
    for (const Schedule* schedule :
         {&policy.rotations, &policy.new_start, &policy.places, &policy.ties}) {
        if (!(schedule->again_when_grown_by >= 0.0))
            return Error{ErrorCode::kInvalidArgument,
                         "a question is asked again when something has grown, by no negative part"};
    }
    return {};
}

}  // namespace psfm
