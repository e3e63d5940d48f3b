// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/upload_store.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>

#include "tools/serve/sha256.h"

namespace psfm {
namespace {

/// What identify_format takes for a PNM photograph; nothing decodes it here.
const std::string kPhoto = "P5\n2 2\n255\nabcd";

class UploadStoreTest : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (std::filesystem::temp_directory_path() / "psfm-XXXXXX").string();
        folder_ = mkdtemp(pattern.data());
        limits_.free_bytes = 0;
        reopen();
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    void reopen() {
        auto store = UploadStore::open(folder_, limits_);
        ASSERT_TRUE(store.ok());
        store_ = *std::move(store);
    }
    UploadStore::Offer offer(const std::string& bytes, std::uint64_t offset = 0) const {
        return {1, sha256_hex(bytes), "a.jpg", offset, bytes.size()};
    }
    unsigned send(const UploadStore::Offer& offer, std::string_view bytes) {
        auto admission = store_->admit(offer);
        if (admission.refusal) return admission.refusal->status;
        if (const auto early = admission.sink->write(bytes)) return early->status;
        return admission.sink->finish().status;
    }
    std::filesystem::path folder_;
    UploadLimits limits_;
    std::unique_ptr<UploadStore> store_;
};

TEST_F(UploadStoreTest, IsAcknowledgedOnceItIsWhole) {
    EXPECT_EQ(send(offer(kPhoto), kPhoto.substr(0, 5)), 204U);
    EXPECT_EQ(store_->progress(1, sha256_hex(kPhoto)).offset, 5U);
    EXPECT_FALSE(store_->take().has_value());
    reopen();  // as after a kill
    EXPECT_EQ(send(offer(kPhoto, 7), kPhoto.substr(7)), 409U);
    EXPECT_EQ(send(offer(kPhoto, 5), kPhoto.substr(5)), 201U);
    const auto photo = store_->take();
    ASSERT_TRUE(photo.has_value());
    EXPECT_EQ(photo->name, "1/" + sha256_hex(kPhoto) + ".ppm");
    EXPECT_TRUE(std::filesystem::exists(photo->path));
    EXPECT_EQ(send(offer(kPhoto), kPhoto), 200U);  // sent again
    EXPECT_FALSE(store_->take().has_value());
}

TEST_F(UploadStoreTest, WhatTheSessionLacksWaitsAgain) {
    ASSERT_EQ(send(offer(kPhoto), kPhoto), 201U);
    reopen();
    store_->queue_missing({});
    EXPECT_EQ(store_->waiting(), 1U);
    reopen();
    store_->queue_missing({"1/" + sha256_hex(kPhoto) + ".ppm"});
    EXPECT_EQ(store_->waiting(), 0U);
}

TEST_F(UploadStoreTest, OtherBytesAndOtherFilesAreRefused) {
    UploadStore::Offer lie = offer(kPhoto);
    lie.sha256 = sha256_hex("something else");
    EXPECT_EQ(send(lie, kPhoto), 422U);
    EXPECT_EQ(store_->progress(1, lie.sha256).offset, 0U);
    EXPECT_EQ(send(offer("no photograph"), "no photograph"), 415U);
    EXPECT_EQ(send(offer(kPhoto), kPhoto + "x"), 413U);
    lie.sha256 = "../../etc/passwd";
    EXPECT_EQ(send(lie, kPhoto), 404U);
}

TEST_F(UploadStoreTest, ALineThatBrokeOffIsPassedOver) {
    ASSERT_EQ(send(offer(kPhoto), kPhoto), 201U);
    std::ofstream(folder_ / "uploads.log", std::ios::app) << "{\"sha256\":\"abc";
    reopen();
    EXPECT_EQ(store_->uploads().size(), 1U);
    const std::string other = kPhoto + "e";
    ASSERT_EQ(send(offer(other), other), 201U);
    reopen();
    EXPECT_EQ(store_->uploads().size(), 2U);
}

TEST_F(UploadStoreTest, NobodySendsTheSameAtTheSameTime) {
    const auto first = store_->admit(offer(kPhoto));
    ASSERT_TRUE(first.sink != nullptr);
    EXPECT_EQ(send(offer(kPhoto), kPhoto), 423U);
}

TEST_F(UploadStoreTest, WhatHasBegunToComeCountsForTheQuota) {
    limits_.quota_bytes = kPhoto.size() + kPhoto.size() / 2;
    reopen();
    const std::string other = kPhoto + "x";
    const std::string_view half = std::string_view(kPhoto).substr(0, kPhoto.size() / 2);
    EXPECT_EQ(send(offer(kPhoto), half), 204U);
    EXPECT_EQ(send(offer(other), other), 507U);
    limits_.quota_bytes = kPhoto.size() + kPhoto.size() / 4;
    reopen();  // also what an earlier process was sent
    EXPECT_EQ(send(offer(other), other), 507U);
    const auto part = folder_ / "photographs" / "1" / (sha256_hex(kPhoto) + ".part");
    std::filesystem::last_write_time(
        part, std::filesystem::file_time_type::clock::now() - std::chrono::hours(25));
    reopen();
    EXPECT_FALSE(std::filesystem::exists(part));
    EXPECT_EQ(send(offer(other), other), 201U);
}

TEST_F(UploadStoreTest, FullIsSaid) {
    limits_.quota_bytes = kPhoto.size();
    reopen();
    EXPECT_EQ(send(offer(kPhoto), kPhoto), 201U);
    EXPECT_EQ(send(offer(kPhoto + "x"), kPhoto + "x"), 507U);
    limits_ = {};
    limits_.free_bytes = std::uint64_t{1} << 60U;
    reopen();
    EXPECT_EQ(send(offer(kPhoto + "x"), kPhoto + "x"), 507U);
    limits_ = {};
    limits_.free_bytes = 0;
    limits_.queue = 0;
    reopen();
    EXPECT_EQ(send(offer(kPhoto + "x"), kPhoto + "x"), 429U);
}

}  // namespace
}  // namespace psfm
