// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/session/installed_vocabulary.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <string>

#include "tests/storage/exchange/example_model.h"

namespace psfm {
namespace {

/// Environment variables as a test wants them, and as they were afterwards.
class InstalledVocabulary : public ::testing::Test {
  protected:
    void SetUp() override {
        for (const char* name : kNames) {
            const char* value = std::getenv(name);
            before_[name] = value == nullptr ? std::nullopt : std::optional<std::string>(value);
            ::unsetenv(name);
        }
    }
    void TearDown() override {
        for (const auto& [name, value] : before_) {
            if (value)
                ::setenv(name.c_str(), value->c_str(), 1);
            else
                ::unsetenv(name.c_str());
        }
    }
    static void set(const char* name, const std::filesystem::path& value) {
        ::setenv(name, value.c_str(), 1);
    }
    static constexpr std::array kNames{"PSFM_VOCABULARY", "XDG_DATA_HOME", "HOME"};
    test::TemporaryFolder folder_;
    std::map<std::string, std::optional<std::string>> before_;
};

TEST_F(InstalledVocabulary, IsThatOfTheUser) {
    EXPECT_EQ(vocabulary_of_user(), "");
    set("HOME", folder_.path());
    EXPECT_EQ(vocabulary_of_user(), folder_.path() / ".local/share/psfm/vocabulary");
    set("XDG_DATA_HOME", folder_.path() / "data");
    EXPECT_EQ(vocabulary_of_user(), folder_.path() / "data/psfm/vocabulary");
    set("PSFM_VOCABULARY", folder_.path() / "words");
    EXPECT_EQ(vocabulary_of_user(), folder_.path() / "words");
    EXPECT_EQ(installed_vocabulary(), "") << "not there";
    std::ofstream(folder_.path() / "words") << "words";
    EXPECT_EQ(installed_vocabulary(), folder_.path() / "words");
    set("PSFM_VOCABULARY", "");
    EXPECT_EQ(installed_vocabulary(), "") << "none is wanted";
}

}  // namespace
}  // namespace psfm
