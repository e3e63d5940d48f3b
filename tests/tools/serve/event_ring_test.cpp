// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/event_ring.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

TEST(EventRing, IsGoneOnWithFromAnId) {
    EventRing ring("s");
    for (const char* data : {"1", "2", "3"}) ring.publish("image", data);
    EXPECT_EQ(ring.number_of("s-2"), 2U);
    const auto events = ring.after(2);
    ASSERT_TRUE(events.has_value());
    ASSERT_EQ(events->size(), 1U);
    EXPECT_EQ(events->front().data, "3");
    EXPECT_EQ(ring.id_of(events->front().number), "s-3");
    EXPECT_TRUE(ring.after(3)->empty());
}

TEST(EventRing, SaysWhatItDoesNotKeep) {
    EventRing ring("s", 2);
    for (int i = 0; i < 5; ++i) ring.publish("image", "");
    EXPECT_FALSE(ring.after(2).has_value());
    EXPECT_EQ(ring.after(3)->size(), 2U);
}

TEST(EventRing, KnowsNoIdOfAnotherServer) {
    const EventRing ring("s");
    for (const char* id : {"t-1", "s1", "s-", "s-1x", "", "s--1"})
        EXPECT_FALSE(ring.number_of(id).has_value()) << id;
}

}  // namespace
}  // namespace psfm
