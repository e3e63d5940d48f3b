// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/shell_word.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>

namespace psfm {
namespace {

/// What a shell makes of a word.
std::string as_read_by_a_shell(const std::string& word) {
    const std::string command = "printf %s " + word;
    FILE* pipe = popen(command.c_str(), "r");
    std::string read;
    std::array<char, 256> buffer{};
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
        read.append(buffer.data(), count);
    pclose(pipe);
    return read;
}

TEST(ShellWord, IsReadBackByAShell) {
    for (const char* argument : {"castle", "/data/two words", "it's", "'", "$(id)", "a;b",
                                 "back\\slash", "*", "~", "Türkei", "two\nlines", "#1", "-n"})
        EXPECT_EQ(as_read_by_a_shell(shell_word(argument)), argument);
}

TEST(ShellWord, LeavesAloneWhatNeedsNoQuotes) {
    EXPECT_EQ(shell_word("/data/castle-P19_2.psfm"), "/data/castle-P19_2.psfm");
    EXPECT_EQ(shell_word(""), "''");
}

}  // namespace
}  // namespace psfm
