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
    const auto back = decode_solve_state(encode_solve_state(state));
    ASSERT_TRUE(back.ok());
    EXPECT_EQ(back->state, state.state);
    EXPECT_TRUE(back->settled);
}

TEST(EncodeState, WhatAnEarlierProgramDidNotKeepIsTheDefault) {
    for (const char* text : {"", "{}", "{\"a later field\":[]}"}) {
        const auto state = decode_solve_state(text);
        ASSERT_TRUE(state.ok()) << text;
        EXPECT_EQ(state->state, SolveState{}) << text;
        EXPECT_FALSE(state->settled) << text;
    }
    const auto some = decode_solve_state(
        R"({"images_at_full_adjustment":17,"tolerated_contradiction_deg":null,"settled":true})");
    ASSERT_TRUE(some.ok());
    EXPECT_EQ(some->state, SolveState{.images_at_full_adjustment = 17});
    EXPECT_TRUE(some->settled);
}

TEST(EncodeState, DamagedSolveStateIsReported) {
    for (const char* text :
         {"{", "[]", "3", R"({"images_at_full_adjustment":-3})", R"({"settled":"yes"})",
          R"({"has_strangers":1})", R"({"images_at_places":4294967296})",
          R"({"tolerated_contradiction_deg":"12"})"}) {
        const auto state = decode_solve_state(text);
        ASSERT_FALSE(state.ok()) << text;
        EXPECT_EQ(state.error().code, ErrorCode::kDamaged);
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
