// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/solve_policy.h"

namespace psfm {

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
