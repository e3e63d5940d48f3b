// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scheduler/session/messages.h"

namespace psfm {

/// What decides whether a version is to be made now. A value, so that the rule can be tested.
struct VersionMoment {
    bool changed = false;        ///< something is to be merged and published
    bool merging = false;        ///< one merge in flight at most
    bool held = false;           ///< a batch before its end
    bool deterministic = false;  ///< see SessionConfig
    bool busy = false;           ///< a cluster is dirty or being solved
    bool all_verified = false;   ///< no acknowledged image waits for its pairs
    bool more_to_come = false;   ///< photographs are waiting, and may come in
    Clock::time_point now = {};
    Clock::time_point not_before = {};  ///< while there is other work: see rest_per_merge
};

/// Deterministic sessions publish when everything is solved; others as soon as there is something
/// new and nothing else to do, or after the rest that the last merge has earned.
inline bool version_is_due(const VersionMoment& moment) {
    if (!moment.changed || moment.merging || moment.held) return false;
    if (moment.deterministic) return !moment.busy;
    const bool quiet = moment.all_verified && !moment.busy;
    return (quiet && !moment.more_to_come) || moment.now >= moment.not_before;
}

}  // namespace psfm
