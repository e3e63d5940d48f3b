// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/cluster_constraint.h"

namespace psfm {

const char* describe(ConstraintVerdict verdict) {
    switch (verdict) {
        case ConstraintVerdict::kAccepted:
            return "accepted";
        case ConstraintVerdict::kNoEdges:
            return "no image pair sees enough points of both models";
        case ConstraintVerdict::kNoSimilarity:
            return "no image pair's points agree on a similarity";
        case ConstraintVerdict::kInterleaved:
            return "every similarity found would interleave the cameras of the two models";
        case ConstraintVerdict::kInconsistent:
            return "the image pairs contradict one another";
    }
    return "unknown";
}

}  // namespace psfm
