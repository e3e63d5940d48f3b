// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/http.h"

#include <gtest/gtest.h>

#include "tools/serve/gzip.h"
#include "tools/serve/uploads/sha256.h"

namespace psfm {
namespace {

TEST(Http, TargetsAreTakenApart) {
    HttpRequest request;
    ASSERT_TRUE(parse_target("/a%20b/c?x=1&y=%26%3d&z", request));
    EXPECT_EQ(request.path, "/a b/c");
    EXPECT_EQ(request.query.at("x"), "1");
    EXPECT_EQ(request.query.at("y"), "&=");
    EXPECT_EQ(request.query.at("z"), "");
}

TEST(Http, StrangeTargetsAreRefused) {
    for (const char* target :
         {"", "*", "http://a/", "/a b", "/%", "/%4", "/%zz", "/%00", "/?x=%0"}) {
        HttpRequest request;
        EXPECT_FALSE(parse_target(target, request)) << target;
    }
}

TEST(Http, ProblemsAreProblemDocuments) {
    const HttpResponse response = problem(409, "a \"quote\"");
    EXPECT_EQ(response.status, 409U);
    EXPECT_EQ(*response.body,
              "{\"type\":\"about:blank\",\"title\":\"Conflict\",\"status\":409,\"detail\":\"a "
              "\\\"quote\\\"\"}\n");
}

TEST(Http, HashesAndBase64AreThoseOfTheStandards) {
    EXPECT_EQ(sha256_hex("abc"),
              "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    Sha256 hash;
    hash.add("a");
    hash.add("bc");
    EXPECT_EQ(hash.hex(), sha256_hex("abc"));
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_TRUE(is_sha256(sha256_hex("")));
    EXPECT_FALSE(is_sha256("../" + sha256_hex("").substr(3)));
}

}  // namespace
}  // namespace psfm
