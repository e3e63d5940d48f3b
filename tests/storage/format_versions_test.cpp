// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "storage/session_folder.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

class FormatVersions : public ::testing::TestWithParam<int> {};

TEST_P(FormatVersions, OfAnEarlierProgramOpenAndGoOn) {
    const testing::TemporaryFolder folder;
    const fs::path fixture =
        fs::path(PSFM_STORAGE_TEST_DATA) / ("format-" + std::to_string(GetParam()));
    fs::copy(fixture, folder.session(), fs::copy_options::recursive);
    {
        const auto reader = open_session_reader(folder.session(), {});
        ASSERT_TRUE(reader.ok()) << reader.error().message;
        EXPECT_EQ((*reader)->images()->size(), 4U);
        EXPECT_EQ(testing::difference(**reader), "");
        EXPECT_TRUE((*reader)->check({})->damaged.empty());
    }
    const auto store = SessionStore::open_existing(folder.session(), {});
    ASSERT_TRUE(store.ok()) << store.error().message;
    EXPECT_TRUE(testing::commit_all(**store, 4));
    EXPECT_EQ(testing::difference(**store), "");
}

INSTANTIATE_TEST_SUITE_P(Every, FormatVersions, ::testing::Range(1, kSessionFormat + 1));

}  // namespace
}  // namespace psfm
