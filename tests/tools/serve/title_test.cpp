// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/uploads/title.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

TEST(Title, IsTextOfOneLine) {
    EXPECT_EQ(title_of("IMG 1.jpg"), "IMG 1.jpg");
    EXPECT_EQ(title_of("Stra\u00dfe \u6f22 \U0001f4f7.jpg"), "Stra\u00dfe \u6f22 \U0001f4f7.jpg");
    EXPECT_EQ(title_of("a\nb\x7f"), "ab");
    EXPECT_EQ(title_of("a\u202egpj.exe"), "agpj.exe");
    EXPECT_EQ(title_of("\u2066a\u2069\u202a\u2028\u2029\u0085"), "a");
    EXPECT_EQ(title_of(" \u202e "), "");
}

TEST(Title, IsUtf8OfBoundedLength) {
    EXPECT_EQ(title_of("a\xff\xc0\xaf\xed\xa0\x80\xe2\x80"), "a");  // none of it is UTF-8
    std::string longest(199, 'a');
    EXPECT_EQ(title_of(longest + "\u00df"), longest);
    EXPECT_EQ(title_of(longest + "bc"), longest + "b");
}

}  // namespace
}  // namespace psfm
