// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/waiting_report.h"

#include <gtest/gtest.h>

#include <set>

namespace psfm {
namespace {

TEST(WhyNothingIsPlaced, NamesTheCommonestCause) {
    using R = WaitReason;
    const std::vector<R> turned{R::kNoParallax, R::kNoParallax, R::kNoParallax, R::kTooFewMatches,
                                R::kTooFewMatches};
    EXPECT_NE(why_nothing_is_placed(turned, {}).find("no parallax"), std::string::npos);
    std::set<std::string> lines;
    for (const R reason : {R::kTooFewMatches, R::kClusterTooSmall, R::kNoSeed, R::kNoParallax,
                           R::kStandsStill, R::kTooFewFeatures, R::kLookAlikes, R::kSolving}) {
        const std::string line = why_nothing_is_placed(std::vector<R>(6, reason), {});
        EXPECT_TRUE(lines.insert(line).second) << line;
        EXPECT_TRUE(line.starts_with("nothing could be placed: ")) << line;
        EXPECT_EQ(line.find('\n'), std::string::npos);
    }
}

TEST(WhyNothingIsPlaced, TooFewPhotographsAreTheCauseWhateverElseIs) {
    const std::vector<WaitReason> few(2, WaitReason::kNoParallax);
    EXPECT_EQ(why_nothing_is_placed(few, {}),
              "nothing could be placed: a model takes at least 3 photographs of one place, and "
              "there are 2; add more");
}

}  // namespace
}  // namespace psfm
