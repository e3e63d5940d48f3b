// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/users.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <iterator>
#include <set>
#include <thread>
#include <vector>

namespace psfm {
namespace {

class UsersTest : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (std::filesystem::temp_directory_path() / "psfm-XXXXXX").string();
        folder_ = mkdtemp(pattern.data());
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::unique_ptr<Users> open() {
        auto users = Users::open(folder_);
        EXPECT_TRUE(users.ok());
        return *std::move(users);
    }
    std::filesystem::path folder_;
};

TEST_F(UsersTest, ATokenIsItsUsersAndIsNowhereElse) {
    const auto token = open()->add("Ada", UserRole::kSend, 0);
    ASSERT_TRUE(token.ok());
    EXPECT_EQ(token->size(), 43U);  // 256 bits in base64
    const auto users = open();
    const auto user = users->of_token(*token);
    ASSERT_TRUE(user.has_value());
    EXPECT_EQ(user->name, "Ada");
    EXPECT_EQ(user->role, UserRole::kSend);
    EXPECT_FALSE(users->of_token(*token + "x").has_value());
    EXPECT_FALSE(users->of_token("").has_value());
    std::ifstream file(folder_ / "users.json");
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    EXPECT_EQ(text.find(*token), std::string::npos);
    struct stat status {};
    ASSERT_EQ(::stat((folder_ / "users.json").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U);
}

TEST_F(UsersTest, TokensExpireAndAreTakenBack) {
    const auto users = open();
    const auto old = users->add("Old", UserRole::kLook, std::time(nullptr) - 1);
    const auto gone = users->add("Gone", UserRole::kLook, 0);
    ASSERT_TRUE(old.ok() && gone.ok());
    EXPECT_FALSE(users->of_token(*old).has_value());
    EXPECT_TRUE(users->of_token(*gone).has_value());
    ASSERT_TRUE(users->remove("Gone").ok());
    EXPECT_FALSE(users->of_token(*gone).has_value());
    EXPECT_EQ(users->remove("Gone").error().code, ErrorCode::kNotFound);
    // His number stays his.
    ASSERT_TRUE(users->add("Gone", UserRole::kLook, 0).ok());
    EXPECT_EQ(users->all().back().number, 3U);
}

TEST_F(UsersTest, NamesAreNamesAndTakenOnce) {
    const auto users = open();
    EXPECT_FALSE(users->add("", UserRole::kLook, 0).ok());
    EXPECT_FALSE(users->add("  ", UserRole::kLook, 0).ok());
    EXPECT_FALSE(users->add("a\nb", UserRole::kLook, 0).ok());
    EXPECT_FALSE(users->add(std::string(65, 'a'), UserRole::kLook, 0).ok());
    EXPECT_TRUE(users->add("a", UserRole::kLook, 0).ok());
    EXPECT_EQ(users->add("a", UserRole::kLook, 0).error().code, ErrorCode::kDuplicate);
}

TEST_F(UsersTest, ThatThereWereUsersIsNotForgotten) {
    EXPECT_FALSE(open()->had_any());
    ASSERT_TRUE(open()->add("Ada", UserRole::kLook, 0).ok());
    const auto users = open();
    EXPECT_TRUE(users->is_valid(1));
    EXPECT_FALSE(users->is_valid(2));
    std::filesystem::remove(folder_ / "users.json");
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!users->empty() && std::chrono::steady_clock::now() < end) ::usleep(100'000);
    EXPECT_TRUE(users->empty());
    EXPECT_TRUE(users->had_any());
    EXPECT_FALSE(users->is_valid(1));
}

TEST_F(UsersTest, AChangeIsOfTheUsersAsTheyAreByThen) {
    const auto first = open(), second = open();
    ASSERT_TRUE(first->add("Ada", UserRole::kSend, 0).ok());
    ASSERT_TRUE(second->add("Bob", UserRole::kSend, 0).ok());
    EXPECT_EQ(second->add("Ada", UserRole::kSend, 0).error().code, ErrorCode::kDuplicate);
    ASSERT_TRUE(second->remove("Ada").ok());
    EXPECT_EQ(first->remove("Ada").error().code, ErrorCode::kNotFound);
    const auto all = open()->all();
    ASSERT_EQ(all.size(), 2U);
    EXPECT_TRUE(all[0].removed);
    EXPECT_EQ(all[1].name, "Bob");
    EXPECT_EQ(all[1].number, 2U);
}

TEST_F(UsersTest, NobodyIsLostWhereManyAreAddedAtOnce) {
    constexpr int kThreads = 4, kEach = 5;
    std::vector<std::thread> threads;
    for (int k = 0; k < kThreads; ++k) {
        threads.emplace_back([&, k] {
            for (int i = 0; i < kEach; ++i) {
                const std::string name = std::to_string(k) + "-" + std::to_string(i);
                const auto users = Users::open(folder_);
                EXPECT_TRUE(users.ok() && (*users)->add(name, UserRole::kSend, 0).ok()) << name;
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    std::set<std::uint32_t> numbers;
    std::set<std::string> names;
    for (const User& user : open()->all()) {
        numbers.insert(user.number);
        names.insert(user.name);
    }
    EXPECT_EQ(numbers.size(), static_cast<std::size_t>(kThreads * kEach));
    EXPECT_EQ(names.size(), static_cast<std::size_t>(kThreads * kEach));
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
        const std::string file = entry.path().filename();
        EXPECT_TRUE(file == "users.json" || file == "users.lock") << file;
    }
}

TEST_F(UsersTest, WhatCannotBeReadIsToldOf) {
    const auto file = folder_ / "users.json";
    std::filesystem::create_symlink("users.json", file);  // leads to itself
    EXPECT_EQ(Users::open(folder_).error().code, ErrorCode::kIo);
    std::filesystem::remove(file);
    std::ofstream(file) << "{\"users\":[{}]}";
    EXPECT_EQ(Users::open(folder_).error().code, ErrorCode::kDamaged);
}

}  // namespace
}  // namespace psfm
