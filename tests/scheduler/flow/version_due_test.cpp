// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/version_due.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

namespace psfm {
namespace {

using std::chrono::seconds;

const Clock::time_point kNow = Clock::time_point{} + seconds(100);

/// Something has changed, nothing else is to be done, and the last merge was a moment ago.
VersionMoment quiet_moment() {
    return {.changed = true, .all_verified = true, .now = kNow, .not_before = kNow + seconds(1)};
}

TEST(VersionDue, AtOnceWhereThereIsNothingElseToDo) {
    EXPECT_TRUE(version_is_due(quiet_moment()));
}

TEST(VersionDue, NeverWithoutAChangeBesideAnotherMergeOrWithinABatch) {
    for (bool VersionMoment::*const deterministic_or_not :
         {&VersionMoment::deterministic, &VersionMoment::all_verified}) {
        VersionMoment moment = quiet_moment();
        moment.*deterministic_or_not = true;
        EXPECT_TRUE(version_is_due(moment));
        VersionMoment unchanged = moment;
        unchanged.changed = false;
        EXPECT_FALSE(version_is_due(unchanged));
        for (bool VersionMoment::*const hindrance :
             {&VersionMoment::merging, &VersionMoment::held}) {
            VersionMoment hindered = moment;
            hindered.*hindrance = true;
            hindered.not_before = kNow;
            EXPECT_FALSE(version_is_due(hindered));
        }
    }
}

TEST(VersionDue, BesideOtherWorkOnlyAfterTheRestOfTheLastMerge) {
    struct Row {
        std::string what;
        bool busy, all_verified, more_to_come;
    };
    const std::vector<Row> table = {{"a solve", true, true, false},
                                    {"an image without pairs", false, false, false},
                                    {"a photograph that may come in", false, true, true}};
    for (const Row& row : table) {
        VersionMoment moment = quiet_moment();
        moment.busy = row.busy;
        moment.all_verified = row.all_verified;
        moment.more_to_come = row.more_to_come;
        EXPECT_FALSE(version_is_due(moment)) << row.what;
        moment.now = moment.not_before;
        EXPECT_TRUE(version_is_due(moment)) << row.what;
    }
}

TEST(VersionDue, DeterministicSessionsWaitForSolvesAndForNoClock) {
    VersionMoment moment = quiet_moment();
    moment.deterministic = true;
    moment.all_verified = false;
    moment.more_to_come = true;
    EXPECT_TRUE(version_is_due(moment));
    moment.busy = true;
    moment.not_before = kNow;
    EXPECT_FALSE(version_is_due(moment));
}

}  // namespace
}  // namespace psfm
