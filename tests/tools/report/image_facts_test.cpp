// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/image_facts.h"

#include <gtest/gtest.h>

#include <set>

#include "tools/report/image_advice.h"

namespace psfm {
namespace {

PastVersion version(std::uint64_t number, std::uint32_t images,
                    std::vector<std::pair<ImageId, WaitReason>> waiting) {
    SceneSummary summary;
    summary.waiting = std::move(waiting);
    return {number, images, 1, encode_summary(summary)};
}

TEST(SinceBook, TellsTheVersionThatFirstHadAnImageAsItIs) {
    const ImageId a{0}, b{1}, c{2}, d{3};
    const std::vector<PastVersion> versions{
        version(1, 1, {{a, WaitReason::kTooFewMatches}}),
        version(2, 2, {{a, WaitReason::kClusterTooSmall}, {b, WaitReason::kClusterTooSmall}}),
        version(3, 3, {{b, WaitReason::kClusterTooSmall}}),
        version(4, 3, {{b, WaitReason::kClusterTooSmall}}),
    };
    SinceBook book;
    for (const PastVersion& one : versions) book.add(one);
    const auto since = book.of(4);
    EXPECT_EQ(since[index_of(a)].version, 3U);  // placed then
    EXPECT_EQ(since[index_of(a)].images, 3U);
    EXPECT_EQ(since[index_of(b)].version, 2U);  // waits for the same reason ever since
    EXPECT_EQ(since[index_of(c)].version, 3U);  // placed at once
    EXPECT_EQ(since[index_of(d)].version, 0U);  // no version knows of it
}

TEST(SinceBook, AnImageThatLosesItsPlaceWaitsSinceThen) {
    const ImageId a{0};
    SinceBook book;
    book.add(version(1, 1, {}));
    book.add(version(2, 1, {}));
    EXPECT_EQ(book.of(1)[0].version, 1U);
    book.add(version(3, 1, {{a, WaitReason::kRegistrationFailed}}));
    EXPECT_EQ(book.of(1)[0].version, 3U);
}

TEST(ImageAdvice, EveryReasonHasACodeOfItsOwnAndAdvice) {
    std::set<std::string> codes;
    for (int reason = 0; reason <= static_cast<int>(WaitReason::kSolving); ++reason) {
        const auto value = static_cast<WaitReason>(reason);
        EXPECT_TRUE(codes.insert(name_of(value)).second) << reason;
        EXPECT_EQ(std::string(advice_for(value)).empty(), value == WaitReason::kNone) << reason;
    }
    EXPECT_FALSE(codes.contains("unknown"));
}

TEST(ImageAdvice, ARejectionIsTakenApartAtItsRemedy) {
    const RejectionWords words = split_rejection("a.jpg", "a.jpg: is truncated; copy it again");
    EXPECT_EQ(words.reason, "is truncated");
    EXPECT_EQ(words.advice, "copy it again");
    EXPECT_EQ(split_rejection("a.jpg", "a.jpg: is no image").advice, "");
}

TEST(ImageAdvice, ARejectionIsToldWithoutTheNameInFrontOfIt) {
    EXPECT_EQ(split_rejection("a.jpg", "a.jpg is a copy of b.jpg").reason, "is a copy of b.jpg");
    EXPECT_EQ(split_rejection("a.jpg", "a.jpg: a.jpg is a folder").reason, "a.jpg is a folder");
    EXPECT_EQ(split_rejection("a", "a.jpg is a folder").reason, "a.jpg is a folder");
    EXPECT_EQ(split_rejection("b.jpg", "a.jpg: is no image").reason, "a.jpg: is no image");
}

}  // namespace
}  // namespace psfm
