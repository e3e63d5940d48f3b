// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "storage/database/session_folder.h"
#include "tests/storage/growing_session.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

class EarlierFormat : public ::testing::TestWithParam<int> {};

TEST_P(EarlierFormat, OfAnEarlierProgramOpenAndGoOn) {
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

TEST(FormatVersions, SolutionsStoredAsChangesOpenAndGoOn) {
    constexpr std::uint32_t kImages = 8;
    const testing::TemporaryFolder again;
    testing::GrowingSession session(testing::kGrownSeed);
    {
        const auto store = SessionStore::open(again.session(), {});
        ASSERT_TRUE(store.ok());
        for (std::uint32_t image = 0; image < kImages; ++image)
            ASSERT_TRUE(session.add_all(**store));
    }
    const testing::TemporaryFolder folder;
    fs::copy(fs::path(PSFM_STORAGE_TEST_DATA) / "changes-2", folder.session(),
             fs::copy_options::recursive);
    const auto store = SessionStore::open_existing(folder.session(), {});
    ASSERT_TRUE(store.ok()) << store.error().message;
    const auto solution = (*store)->solution(ClusterId{0});
    ASSERT_TRUE(solution.ok()) << solution.error().message;
    ASSERT_TRUE(solution->has_value());
    const std::shared_ptr<const Reconstruction> model = (*solution)->model;
    EXPECT_TRUE(testing::same_poses(*model, *session.model()));
    EXPECT_TRUE(testing::same_points(*model, *session.model()));
    EXPECT_TRUE(session.add_image(**store) && session.solve(**store, model) &&
                session.publish(**store));
    const auto report = (*store)->check({});
    ASSERT_TRUE(report.ok());
    EXPECT_TRUE(report->damaged.empty());
    EXPECT_TRUE(
        testing::same_points(*(*(*store)->solution(ClusterId{0}))->model, *session.model()));
}

INSTANTIATE_TEST_SUITE_P(Every, EarlierFormat, ::testing::Range(1, kSessionFormat + 1));

}  // namespace
}  // namespace psfm
