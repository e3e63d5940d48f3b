// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/text.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

TEST(TextTest, KnowsUtf8) {
    for (const char* text :
         {"", "plain", "h\xC3\xA4user", "\xE2\x82\xAC", "\xF0\x9F\x8F\x9B", "\xF4\x8F\xBF\xBF"}) {
        EXPECT_TRUE(is_valid_utf8(text)) << text;
    }
    // Lone bytes, cut characters, overlong forms, surrogates, beyond U+10FFFF.
    for (const char* text :
         {"\x80", "\xFF", "\xC3", "\xE2\x82", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80",
          "\xF0\x80\x80\xAF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80"}) {
        EXPECT_FALSE(is_valid_utf8(text)) << printable(text);
    }
}

TEST(TextTest, FindsControlCharacters) {
    EXPECT_FALSE(has_control_characters("two words \xC3\xA4"));
    EXPECT_TRUE(has_control_characters("two\nlines"));
    EXPECT_TRUE(has_control_characters("\x7F"));
    EXPECT_TRUE(has_control_characters("\xC2\x85"));  // U+0085, next line
}

TEST(TextTest, PrintsOnOneLine) {
    EXPECT_EQ(printable("h\xC3\xA4user"), "h\xC3\xA4user");
    EXPECT_EQ(printable("a\nb\\c\xFF"), "a\\x0ab\\x5cc\\xff");
}

}  // namespace
}  // namespace psfm
