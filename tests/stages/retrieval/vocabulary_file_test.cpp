// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/vocabulary_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "stages/retrieval/train_vocabulary.h"
#include "tests/stages/retrieval/planted_descriptors.h"

namespace psfm {
namespace {

using testing::HasSubstr;

class VocabularyFile : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("psfm_vocabulary_" + std::to_string(::getpid()) + "_" +
                   testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path file() const { return folder_ / "words.psfm"; }
    std::string bytes() const {
        std::ifstream in(file(), std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void put(const std::string& content) const {
        std::ofstream out(file(), std::ios::binary | std::ios::trunc);
        out << content;
    }

    std::filesystem::path folder_;
    WordTree tree_ =
        train_vocabulary(synthetic::random_points(60, 1), {.words = 12, .iterations = 2});
};

TEST_F(VocabularyFile, ReadsWhatWasWritten) {
    ASSERT_TRUE(write_vocabulary(tree_, file()).ok());
    const auto read = read_vocabulary(file());
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(*read, tree_);
    EXPECT_EQ(bytes().size(), 32 + tree_.cells.rows() * 132 + tree_.word_count() * 128);
    EXPECT_EQ(bytes().substr(0, 12), std::string("psfmVOC\0\1\0\0\0", 12));
    // Nothing else is left in the folder, and an existing file is replaced.
    ASSERT_TRUE(write_vocabulary(tree_, file()).ok());
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(VocabularyFile, EveryFlippedBitIsNoticed) {
    ASSERT_TRUE(write_vocabulary(tree_, file()).ok());
    const std::string good = bytes();
    for (std::size_t at = 0; at < good.size(); at += at < 200 ? 1 : 37) {
        std::string bad = good;
        bad[at] = static_cast<char>(bad[at] ^ (1 << (at % 8)));
        put(bad);
        const auto read = read_vocabulary(file());
        ASSERT_FALSE(read.ok()) << "byte " << at;
        EXPECT_THAT(read.error().message, HasSubstr("words.psfm"));
    }
}

TEST_F(VocabularyFile, EveryTruncationAndAdditionIsNoticed) {
    ASSERT_TRUE(write_vocabulary(tree_, file()).ok());
    const std::string good = bytes();
    for (std::size_t size = 0; size < good.size(); size += size < 40 ? 1 : 101) {
        put(good.substr(0, size));
        EXPECT_FALSE(read_vocabulary(file()).ok()) << size;
    }
    put(good + "x");
    EXPECT_EQ(read_vocabulary(file()).error().code, ErrorCode::kDamaged);
}

TEST_F(VocabularyFile, HugeCountsAllocateNothing) {
    ASSERT_TRUE(write_vocabulary(tree_, file()).ok());
    std::string bad = bytes();
    for (std::size_t at = 12; at < 24; ++at) bad[at] = static_cast<char>(0xFF);
    put(bad);
    EXPECT_EQ(read_vocabulary(file()).error().code, ErrorCode::kDamaged);
}

TEST_F(VocabularyFile, WrongFilesAreToldApart) {
    EXPECT_EQ(read_vocabulary(file()).error().code, ErrorCode::kNotFound);
    EXPECT_EQ(read_vocabulary(folder_).error().code, ErrorCode::kUnreadable);
    put("a text that is longer than any header of a vocabulary");
    EXPECT_EQ(read_vocabulary(file()).error().code, ErrorCode::kUnreadable);
    EXPECT_THAT(read_vocabulary(file()).error().message, HasSubstr("psfm vocabulary train"));
    ASSERT_TRUE(write_vocabulary(tree_, file()).ok());
    std::string newer = bytes();
    newer[8] = 2;
    put(newer);
    EXPECT_EQ(read_vocabulary(file()).error().code, ErrorCode::kVersion);
}

TEST_F(VocabularyFile, UnwritablePlacesAndEmptyTreesAreRefused) {
    EXPECT_FALSE(write_vocabulary(tree_, folder_ / "missing" / "words.psfm").ok());
    EXPECT_EQ(write_vocabulary(WordTree{}, file()).error().code, ErrorCode::kInvalidArgument);
    std::filesystem::create_directories(file());
    EXPECT_FALSE(write_vocabulary(tree_, file()).ok());
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}),
              1);  // no temporary left
}

}  // namespace
}  // namespace psfm
