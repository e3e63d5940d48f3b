// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What is made of a decoder that a photograph has taken over. The decoder is this program, called
// again: what it says is the photograph's own content.
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "tools/serve/decoding/decoder_forks.h"
#include "tools/serve/decoding/sandbox.h"

namespace psfm {
namespace {

/// Says what the file has, or nothing for a long time, or nothing at all.
int lie(const DecoderWords& words) {
    std::ifstream stream(words.front(), std::ios::binary);
    const std::string said((std::istreambuf_iterator<char>(stream)), {});
    if (said == "sleep") ::sleep(60);
    if (said == "break") ::abort();
    const auto count = ::write(STDOUT_FILENO, said.data(), said.size());
    return count == static_cast<ssize_t>(said.size()) ? 0 : 1;
}

/// Before main(), where this program is to decode.
const bool kIsTest = [] {
    std::ifstream words("/proc/self/cmdline");
    std::string word;
    std::getline(words, word, '\0');
    if (!std::getline(words, word, '\0') || word != "decode-photograph") return true;
    ::_exit(fork_decoders(lie));
}();

std::string answer(const std::string& head, float x = 0.F, std::uint32_t count = 1) {
    const auto number = [](std::size_t value) {
        const auto bytes = static_cast<std::uint32_t>(value);
        return std::string(reinterpret_cast<const char*>(&bytes), sizeof(bytes));
    };
    Keypoint point;
    point.x = x;
    point.scale = 1.F;
    return "PSX1" + number(head.size()) + head + number(count) +
           std::string(reinterpret_cast<const char*>(&point), sizeof(point)) +
           std::string(Descriptors::kSize, '\1');
}

class SandboxedDecode : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(kIsTest);
        std::string pattern = testing::TempDir() + "/psfm-XXXXXX";
        folder_ = mkdtemp(pattern.data());
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    Result<ExtractedPhoto> decoded(const std::string& said, int seconds = 30) const {
        const auto file = folder_ / "a.jpg";
        std::ofstream(file, std::ios::binary) << said;
        return extract_in_sandbox({file, "a.jpg"}, "default", seconds);
    }
    std::filesystem::path folder_;
    std::string fine_ =
        R"({"width":100,"height":80,"make":"","model":"","orientation":1,"focal_px":90.0})";
};

TEST_F(SandboxedDecode, ItsAnswerIsChecked) {
    const auto fine = decoded(answer(fine_, 99.F));
    ASSERT_TRUE(fine.ok()) << fine.error().message;
    EXPECT_EQ(fine->keypoints.size(), 1U);
    for (const std::string& lie :
         {std::string("hello"), answer(fine_, 101.F), answer(fine_, std::nanf("")),
          answer(fine_, 1.F, 0xffffffffU), answer(fine_, 1.F, 2), answer(fine_) + "x",
          answer(R"({"width":0,"height":80,"make":"","model":"","orientation":1})"),
          answer(R"({"width":100,"height":80,"make":"","model":"","orientation":9})"),
          answer(R"({"width":"x"})"), answer("{"), answer(fine_).substr(0, 30)}) {
        EXPECT_FALSE(decoded(lie).ok()) << lie.substr(8, 90);
    }
}

TEST_F(SandboxedDecode, OneThatBreaksIsFollowedByOthers) {
    EXPECT_FALSE(decoded("break").ok());
    EXPECT_TRUE(decoded(answer(fine_, 99.F)).ok());
}

TEST_F(SandboxedDecode, ManyAtOnceGetTheirOwnAnswers) {
    std::vector<std::thread> threads;
    std::atomic<int> right = 0;
    for (int i = 0; i < 8; ++i) {
        const auto file = folder_ / (std::to_string(i) + ".jpg");
        std::ofstream(file, std::ios::binary) << answer(fine_, static_cast<float>(i));
        threads.emplace_back([&right, file, i] {
            for (int k = 0; k < 5; ++k) {
                const auto one = extract_in_sandbox({file, "a.jpg"}, "default");
                if (one.ok() && one->keypoints.at(0).x == static_cast<float>(i)) ++right;
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(right.load(), 40);
}

TEST_F(SandboxedDecode, ItsTimeIsLimited) {
    const auto start = std::chrono::steady_clock::now();
    const auto late = decoded("sleep", 1);
    EXPECT_FALSE(late.ok());
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
}

}  // namespace
}  // namespace psfm
