// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/files/json_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace psfm {
namespace {

TEST(JsonText, KeepsTheOrderOfOrderedObjectsAlone) {
    EXPECT_EQ(json_text(nlohmann::ordered_json{{"b", 1}, {"a", 2}}), R"({"b":1,"a":2})");
    EXPECT_EQ(json_text(nlohmann::json{{"b", 1}, {"a", 2}}), R"({"a":2,"b":1})");
    EXPECT_EQ(json_text(nlohmann::ordered_json{{"b", 1}}, 1), "{\n \"b\": 1\n}");
}

TEST(JsonText, ReplacesWhatIsNoText) {
    EXPECT_EQ(json_text(nlohmann::json("\xFFx")), "\"\xEF\xBF\xBDx\"");
    EXPECT_EQ(json_text(nlohmann::ordered_json("\xFFx")), "\"\xEF\xBF\xBDx\"");
}

TEST(JsonText, ReadsWhatItWrites) {
    const std::string text = R"({"b":[1,2.5,null],"a":"x"})";
    EXPECT_EQ(json_text(parse_ordered_json(text)), text);
    EXPECT_EQ(parse_json(text).at("b").at(1), 2.5);
}

TEST(JsonText, TellsWhatIsNoJson) {
    for (const char* text : {"", "{", "{\"a\":1}x", "nothing"}) {
        EXPECT_TRUE(parse_json(text).is_discarded()) << text;
        EXPECT_TRUE(parse_ordered_json(text).is_discarded()) << text;
    }
    EXPECT_THROW(parse_json("{").at("a"), nlohmann::json::exception);
}

}  // namespace
}  // namespace psfm
