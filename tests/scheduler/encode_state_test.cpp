// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/encode_state.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

TEST(EncodeState, SolveStateSurvives) {
    const StoredSolveState state{{.images_at_full_adjustment = 17,
                                  .tolerated_contradiction_deg = 12.5,
                                  .images_at_contradiction = 20,
                                  .new_start_is_due = true,
                                  .images_at_start = 9,
                                  .images_at_places = 16,
                                  .has_strangers = true,
                                  .weaknesses = {5}},
                                 true};
    const StoredSolveState back = decode_solve_state(encode_solve_state(state));
    EXPECT_EQ(back.state, state.state);
    EXPECT_TRUE(back.settled);
}

TEST(EncodeState, ForeignSolveStateIsTheDefault) {
    for (const char* text :
         {"", "{", "[]", "{\"images_at_full_adjustment\":-3,\"settled\":\"yes\"}"}) {
        EXPECT_EQ(decode_solve_state(text).state, SolveState{}) << text;
    }
}

TEST(EncodeState, SummarySurvives) {
    SceneSummary summary;
    summary.counts.images = 10;
    summary.counts.placed = 8;
    summary.counts.version = 12;
    summary.counts.solves_extend = 5;
    summary.waiting = {{static_cast<ImageId>(3), WaitReason::kTooFewMatches},
                       {static_cast<ImageId>(9), WaitReason::kNoSeed},
                       {static_cast<ImageId>(10), WaitReason::kTooFewFeatures}};
    summary.weak = {{static_cast<ClusterId>(2), 7, {5}}};
    summary.events = {{36, "reset", "cluster 0 was reset: …"}, {40, "join", "cluster 0 …"}};
    const auto back = decode_summary(encode_summary(summary));
    ASSERT_TRUE(back.ok());
    EXPECT_EQ(back->counts.placed, 8U);
    EXPECT_EQ(back->counts.version, 12U);
    EXPECT_EQ(back->counts.solves_extend, 5U);
    EXPECT_EQ(back->waiting, summary.waiting);
    EXPECT_EQ(back->events, summary.events);
    EXPECT_EQ(back->weak, summary.weak);
}

TEST(EncodeState, DamagedSummaryIsReported) {
    EXPECT_TRUE(decode_summary("").ok()) << "an empty session has none";
    for (const char* text :
         {"{", "[]", "{\"waiting_images\":[[1]]}", "{\"waiting_images\":3}",
          "{\"placed\":\"x\",\"waiting_images\":[]}", "{\"waiting_images\":[],\"events\":[{}]}",
          "{\"placed\":1e300,\"waiting_images\":[]}", "{\"placed\":-1,\"waiting_images\":[]}",
          "{\"placed\":4294967296,\"waiting_images\":[]}", "{\"waiting_images\":[[1e300,1]]}",
          "{\"waiting_images\":[[1,-1]]}"}) {
        ASSERT_FALSE(decode_summary(text).ok()) << text;
        EXPECT_EQ(decode_summary(text).error().code, ErrorCode::kDamaged);
    }
}

}  // namespace
}  // namespace psfm
