// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tools/serve/gzip.h"
#include "tools/serve/uploads/sha256.h"

namespace psfm {
namespace {

TEST(Encoding, HashesAreThoseOfTheStandard) {
    EXPECT_EQ(sha256_hex("abc"),
              "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    Sha256 hash;
    hash.add("a");
    hash.add("bc");
    EXPECT_EQ(hash.hex(), sha256_hex("abc"));
    EXPECT_TRUE(is_sha256(sha256_hex("")));
    EXPECT_FALSE(is_sha256("../" + sha256_hex("").substr(3)));
    EXPECT_FALSE(is_sha256("abc"));
}

TEST(Encoding, Base64IsThatOfTheStandard) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(Encoding, GzipIsSmallerAndTheSameEachTime) {
    const std::string text(10000, 'a');
    EXPECT_LT(gzipped(text).size(), 200U);
    EXPECT_EQ(gzipped(text), gzipped(text));
    EXPECT_EQ(gzipped(text).substr(0, 2), "\x1f\x8b");
}

}  // namespace
}  // namespace psfm
