// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/upload_store.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>
#include <fstream>
#include <vector>

#include "tools/serve/uploads/sent_photographs.h"
#include "tools/serve/uploads/sha256.h"

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
    static UploadStore::Offer offer(const std::string& bytes, std::uint64_t offset = 0,
                                    std::uint32_t user = 1) {
        return {user, sha256_hex(bytes), "a.jpg", offset, bytes.size(), false};
    }
    std::filesystem::path part_of(const std::string& bytes, std::uint32_t user = 1) const {
        return folder_ / "photographs" / std::to_string(user) /
               (sha256_hex(bytes) + "." + std::to_string(bytes.size()) + ".part");
    }
    static void age(const std::filesystem::path& file) {
        std::filesystem::last_write_time(
            file, std::filesystem::file_time_type::clock::now() - std::chrono::hours(25));
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

TEST_F(UploadStoreTest, TheEndingIsOfTheContent) {
    for (const auto& [brand, ending] : {std::pair("avif", ".avif"), std::pair("avis", ".avif"),
                                        std::pair("heic", ".heic"), std::pair("mif1", ".heic")}) {
        const std::string photo = std::string("\0\0\0\x10", 4) + "ftyp" + brand + "1234";
        ASSERT_EQ(send(offer(photo), photo), 201U) << brand;
        EXPECT_EQ(store_->take()->name, "1/" + sha256_hex(photo) + ending);
    }
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
    EXPECT_EQ(store_->uploads_of(1).size(), 1U);
    const std::string other = kPhoto + "e";
    ASSERT_EQ(send(offer(other), other), 201U);
    reopen();
    EXPECT_EQ(store_->uploads_of(1).size(), 2U);
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
    age(part_of(kPhoto));
    reopen();
    EXPECT_FALSE(std::filesystem::exists(part_of(kPhoto)));
    EXPECT_EQ(send(offer(other), other), 201U);
}

TEST_F(UploadStoreTest, WhatHasBegunToComeGoesAfterADayWhileTheServerRuns) {
    limits_.abandoned_seconds = 0;
    limits_.quota_bytes = kPhoto.size() + kPhoto.size() / 2;
    reopen();
    const std::string other = kPhoto + "x";
    EXPECT_EQ(send(offer(kPhoto), kPhoto.substr(0, 5)), 204U);
    EXPECT_EQ(send(offer(other), other), 507U);
    EXPECT_TRUE(std::filesystem::exists(part_of(kPhoto)));
    age(part_of(kPhoto));
    EXPECT_EQ(send(offer(other), other), 201U);
    EXPECT_FALSE(std::filesystem::exists(part_of(kPhoto)));
    EXPECT_EQ(send(offer(kPhoto, 5), kPhoto.substr(5)), 409U);
}

TEST_F(UploadStoreTest, WhatIsBeingSentIsNotAbandoned) {
    limits_.abandoned_seconds = 0;
    reopen();
    EXPECT_EQ(send(offer(kPhoto), kPhoto.substr(0, 5)), 204U);
    const auto upload = store_->admit(offer(kPhoto, 5));
    ASSERT_TRUE(upload.sink != nullptr);
    age(part_of(kPhoto));
    EXPECT_EQ(send(offer(kPhoto + "x"), kPhoto + "x"), 201U);
    EXPECT_FALSE(upload.sink->write(kPhoto.substr(5)).has_value());
    EXPECT_EQ(upload.sink->finish().status, 201U);
}

TEST_F(UploadStoreTest, TheLengthThatWasAnnouncedFirstHolds) {
    EXPECT_EQ(send(offer(kPhoto), kPhoto.substr(0, 5)), 204U);
    UploadStore::Offer small = offer(kPhoto, 5);
    small.length = 6;
    EXPECT_EQ(send(small, "x"), 409U);
    reopen();
    EXPECT_EQ(send(small, "x"), 409U);
    EXPECT_EQ(store_->progress(1, sha256_hex(kPhoto)).length, kPhoto.size());
    small.length.reset();  // as announced
    EXPECT_EQ(send(small, kPhoto.substr(5)), 201U);
    EXPECT_EQ(send({1, sha256_hex(kPhoto + "x"), "", 0, std::nullopt, false}, "x"), 400U);
    EXPECT_EQ(send({1, sha256_hex(""), "", 0, 0, true}, ""), 422U);
}

TEST_F(UploadStoreTest, WhatWasNotLookedAtIsNotWhole) {
    EXPECT_FALSE(store_->admit(offer(kPhoto)).sink->write(kPhoto).has_value());
    reopen();  // killed after the last byte
    const auto here = store_->progress(1, sha256_hex(kPhoto));
    EXPECT_EQ(here.offset, kPhoto.size() - 1);
    EXPECT_FALSE(here.complete);
    EXPECT_EQ(send(offer(kPhoto, here.offset), kPhoto.substr(here.offset)), 201U);
}

TEST_F(UploadStoreTest, NothingThatIsHereIsWrittenOver) {
    EXPECT_EQ(send(offer(kPhoto), kPhoto.substr(0, 5)), 204U);
    for (const std::uint64_t at : {0U, 4U, 6U}) EXPECT_EQ(send(offer(kPhoto, at), "xx"), 409U);
    EXPECT_EQ(send(offer(kPhoto, 5), kPhoto.substr(5)), 201U);
    const std::string other = kPhoto + "x";
    EXPECT_EQ(send(offer(other), std::string(other.size(), 'P')), 422U);
    EXPECT_EQ(send(offer(other), other.substr(0, 3)), 204U);
    UploadStore::Offer anew = offer(other);
    anew.anew = true;
    EXPECT_EQ(send(anew, other), 201U);
}

TEST_F(UploadStoreTest, OneUserLeavesRoomForOthers) {
    std::vector<UploadStore::Admission> open;
    for (std::size_t k = 0; k < limits_.at_once_of_user; ++k) {
        open.push_back(store_->admit(offer(kPhoto + std::to_string(k))));
        ASSERT_TRUE(open.back().sink != nullptr);
    }
    EXPECT_EQ(send(offer(kPhoto), kPhoto), 429U);
    EXPECT_EQ(send(offer(kPhoto, 0, 2), kPhoto), 201U);
    open.pop_back();
    EXPECT_EQ(send(offer(kPhoto + "x"), kPhoto + "x"), 201U);
    while (open.size() < limits_.at_once) {
        const auto user = static_cast<std::uint32_t>(open.size());
        open.push_back(store_->admit(offer(kPhoto + "of " + std::to_string(user), 0, user + 2)));
        ASSERT_TRUE(open.back().sink != nullptr);
    }
    EXPECT_EQ(send(offer(kPhoto + "y", 0, 99), kPhoto + "y"), 429U);
}

TEST_F(UploadStoreTest, WhoSendsItTooHasSentIt) {
    ASSERT_EQ(send(offer(kPhoto), kPhoto), 201U);
    UploadStore::Offer too = offer(kPhoto, 0, 2);
    too.title = "hers.jpg";
    EXPECT_FALSE(store_->progress(2, too.sha256).complete);
    for (int k = 0; k < 2; ++k) {
        EXPECT_EQ(send(too, kPhoto), 200U);
        EXPECT_TRUE(store_->progress(2, too.sha256).complete);
        ASSERT_EQ(store_->uploads_of(2).size(), 1U);
        EXPECT_EQ(store_->uploads_of(2).front().title, "hers.jpg");
        EXPECT_EQ(store_->uploads_of(1).size(), 1U);
        EXPECT_EQ(store_->origin_of(store_->uploads_of(1).front().file)->title, "a.jpg");
        reopen();
    }
    store_->queue_missing({});
    EXPECT_EQ(store_->waiting(), 1U);
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

TEST_F(UploadStoreTest, WhatWasTakenBackIsGoneAndMayComeAgain) {
    const auto hash = offer(kPhoto).sha256;
    ASSERT_EQ(send(offer(kPhoto), kPhoto), 201U);
    const std::string file = store_->uploads_of(1).front().file;
    EXPECT_EQ(store_->remove(2, hash, false).status, 404U);
    EXPECT_EQ(store_->remove(1, hash, false).status, 204U);
    for (int k = 0; k < 2; ++k) {
        EXPECT_TRUE(store_->uploads_of(1).empty());
        EXPECT_FALSE(std::filesystem::exists(store_->folder() / file));
        EXPECT_EQ(store_->take_removed(), std::vector<std::string>{file});
        EXPECT_FALSE(store_->has_removed());
        reopen();  // a session may have it still
    }
    UploadStore::Offer again = offer(kPhoto);
    again.title = "again.jpg";
    ASSERT_EQ(send(again, kPhoto), 201U);
    for (int k = 0; k < 2; ++k) {
        EXPECT_FALSE(store_->has_removed()) << "nothing of it is to be taken out";
        EXPECT_EQ(store_->origin_of(file)->title, "again.jpg");
        EXPECT_TRUE(std::filesystem::exists(store_->folder() / file));
        reopen();
    }
    EXPECT_EQ(SentPhotographs(folder_)(file)->title, "again.jpg") << "for who only reads the log";
}

TEST_F(UploadStoreTest, APhotographIsOfTheNextWhoSentIt) {
    const auto hash = offer(kPhoto).sha256;
    ASSERT_EQ(send(offer(kPhoto), kPhoto), 201U);
    UploadStore::Offer too = offer(kPhoto, 0, 2);
    too.title = "hers.jpg";
    EXPECT_EQ(send(too, kPhoto), 200U);
    const std::string file = store_->uploads_of(1).front().file;
    EXPECT_EQ(store_->remove(1, hash, false).status, 204U);
    for (int k = 0; k < 2; ++k) {
        EXPECT_EQ(store_->origin_of(file)->user, 2U);
        EXPECT_EQ(store_->origin_of(file)->title, "hers.jpg");
        EXPECT_TRUE(store_->uploads_of(1).empty());
        EXPECT_FALSE(store_->has_removed());
        reopen();
    }
    EXPECT_EQ(store_->remove(7, hash, true).status, 204U) << "the owner";
    EXPECT_FALSE(store_->origin_of(file));
    EXPECT_FALSE(std::filesystem::exists(store_->folder() / file));
}

TEST_F(UploadStoreTest, WhoHadBegunWhatSomebodyElseCompletedTakesAllOfItBack) {
    const auto hash = offer(kPhoto).sha256;
    EXPECT_EQ(send(offer(kPhoto, 0, 2), kPhoto.substr(0, 5)), 204U);
    ASSERT_EQ(send(offer(kPhoto), kPhoto), 201U);
    const std::string file = store_->uploads_of(1).front().file;
    EXPECT_EQ(send(offer(kPhoto, 5, 2), kPhoto.substr(5)), 200U);
    EXPECT_FALSE(std::filesystem::exists(part_of(kPhoto, 2)));
    EXPECT_EQ(store_->uploads_of(2).size(), 1U);
    EXPECT_EQ(store_->remove(2, hash, false).status, 204U);
    EXPECT_TRUE(store_->uploads_of(2).empty());
    EXPECT_EQ(store_->remove(1, hash, false).status, 204U);
    EXPECT_FALSE(std::filesystem::exists(store_->folder() / file));
    EXPECT_FALSE(store_->find(hash));
}

TEST_F(UploadStoreTest, APartBesideWhatWasSentIsTakenBackWithIt) {
    const auto hash = offer(kPhoto).sha256;
    ASSERT_EQ(send(offer(kPhoto), kPhoto), 201U);
    const std::string file = store_->uploads_of(1).front().file;
    std::ofstream(part_of(kPhoto)) << kPhoto.substr(0, 5);
    reopen();
    EXPECT_EQ(store_->remove(1, hash, false).status, 204U);
    EXPECT_FALSE(std::filesystem::exists(part_of(kPhoto)));
    EXPECT_FALSE(std::filesystem::exists(store_->folder() / file));
    EXPECT_TRUE(store_->uploads_of(1).empty());
}

TEST_F(UploadStoreTest, WhatHasBegunToComeIsTakenBackAlone) {
    const auto hash = offer(kPhoto).sha256;
    EXPECT_EQ(send(offer(kPhoto, 0, 2), kPhoto.substr(0, 5)), 204U);
    ASSERT_EQ(send(offer(kPhoto), kPhoto), 201U);
    EXPECT_EQ(store_->remove(2, hash, false).status, 204U);
    EXPECT_FALSE(std::filesystem::exists(part_of(kPhoto, 2)));
    EXPECT_EQ(store_->remove(2, hash, false).status, 404U);
    EXPECT_EQ(store_->uploads_of(1).size(), 1U) << "hers stays";
}

}  // namespace
}  // namespace psfm
