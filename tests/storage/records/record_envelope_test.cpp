// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/records/record_envelope.h"

#include <gtest/gtest.h>

#include "storage/records/image_records.h"
#include "storage/records/record_key.h"

namespace psfm {
namespace {

const std::string kKey = encode_key(ImageId{7});

TEST(RecordEnvelope, GivesThePayloadBack) {
    for (const std::string& payload :
         {std::string(), std::string("a"), std::string(5000, '\xff')}) {
        const std::string value = seal_record(RecordKind::kPairs, kKey, payload);
        EXPECT_EQ(value.size(), payload.size() + kEnvelopeSize);
        const auto opened = open_record(RecordKind::kPairs, kKey, value);
        ASSERT_TRUE(opened.ok());
        EXPECT_EQ(*opened, payload);
    }
}

TEST(RecordEnvelope, FindsEveryChangedByte) {
    const std::string value = seal_record(RecordKind::kPairs, kKey, "some payload");
    for (std::size_t i = 0; i < value.size(); ++i) {
        for (int mask = 1; mask < 256; ++mask) {
            std::string changed = value;
            changed[i] = static_cast<char>(changed[i] ^ mask);
            const auto opened = open_record(RecordKind::kPairs, kKey, changed);
            ASSERT_FALSE(opened.ok());
            EXPECT_EQ(opened.error().code, ErrorCode::kDamaged);
        }
    }
}

TEST(RecordEnvelope, FindsEveryTruncationAndAddition) {
    const std::string value = seal_record(RecordKind::kPairs, kKey, "some payload");
    for (std::size_t size = 0; size < value.size(); ++size) {
        EXPECT_FALSE(open_record(RecordKind::kPairs, kKey, value.substr(0, size)).ok());
    }
    EXPECT_FALSE(open_record(RecordKind::kPairs, kKey, value + '\0').ok());
}

TEST(RecordEnvelope, FindsARecordUnderAnotherKeyOrKind) {
    const std::string value = seal_record(RecordKind::kPairs, kKey, "some payload");
    EXPECT_FALSE(open_record(RecordKind::kPairs, encode_key(ImageId{8}), value).ok());
    EXPECT_FALSE(open_record(RecordKind::kImage, kKey, value).ok());
}

TEST(RecordEnvelope, RefusesANewerVersion) {
    const std::string value = seal_record(RecordKind::kPairs, kKey, "payload", 2);
    const auto opened = open_record(RecordKind::kPairs, kKey, value);
    ASSERT_FALSE(opened.ok());
    EXPECT_EQ(opened.error().code, ErrorCode::kVersion);
}

/// The bytes printed in FORMAT.md, section 9.
TEST(RecordEnvelope, MatchesTheWorkedExample) {
    Keypoint keypoint;
    keypoint.x = 1.5F;
    keypoint.y = 2.25F;
    keypoint.scale = 3.F;
    keypoint.red = 10;
    keypoint.green = 20;
    keypoint.blue = 30;
    const auto payload = encode_keypoints({keypoint});
    ASSERT_TRUE(payload.ok());
    const std::string value = seal_record(RecordKind::kKeypoints, kKey, *payload);
    std::string hex;
    for (const char byte : value) {
        constexpr const char* kDigits = "0123456789abcdef";
        hex.push_back(kDigits[static_cast<unsigned char>(byte) / 16]);
        hex.push_back(kDigits[static_cast<unsigned char>(byte) % 16]);
    }
    EXPECT_EQ(hex,
              "7073666d06000100140000000000000006be75f4cfbff3dc"
              "0000c03f0000104000004040000000000a141e00");
}

}  // namespace
}  // namespace psfm
