// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/intake.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "tests/scheduler/flow/serial_session.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

ExtractedMessage message_of(const std::string& name, std::uint64_t hash) {
    ExtractedPhoto photo;
    photo.metadata.width = 640;
    photo.metadata.height = 480;
    photo.metadata.content_hash = hash;
    photo.keypoints = testing::expected_keypoints(0);
    photo.descriptors = testing::expected_descriptors(0);
    ExtractedMessage message;
    message.file.name = name;
    message.photo = std::make_shared<const Result<ExtractedPhoto>>(std::move(photo));
    return message;
}

class IntakeTest : public ::testing::Test {
  protected:
    IntakeTest() : store_(test::open_store(folder_)) {}

    /// Whether the photograph became an image.
    bool take(const ExtractedMessage& message) {
        ImageReports reports(config_, state_, outbox_);
        Intake intake(*store_, config_, options_, state_, reports, outbox_);
        const auto taken = intake.take(message);
        EXPECT_TRUE(taken.ok());
        return taken.ok() && *taken != nullptr;
    }
    std::string told() const {
        return outbox_.events.empty() ? std::string() : outbox_.events.back().text;
    }

    testing::TemporaryFolder folder_;
    std::unique_ptr<SessionStore> store_;
    SessionConfig config_;
    StageOptions options_;
    SessionState state_{5};
    Outbox outbox_;
};

TEST_F(IntakeTest, ANewPhotographIsAnImageThatIsStoredAndWaitsForItsPairs) {
    EXPECT_TRUE(take(message_of("a.jpg", 1)));
    ASSERT_EQ(state_.photographs.images.size(), 1U);
    EXPECT_EQ(store_->images()->size(), 1U);
    EXPECT_EQ(state_.pending.size(), 1U);
    EXPECT_EQ(outbox_.images_released, 0U) << "its token is held until a version shows it";
    EXPECT_NEAR(state_.photographs.cameras.at(CameraId{0}).fx(), 1.2 * 640, 1e-9);
}

TEST_F(IntakeTest, TheGuessOfAFocalLengthIsAnOption) {
    options_.features.unknown_focal = 0.7;
    EXPECT_TRUE(take(message_of("a.jpg", 1)));
    EXPECT_NEAR(state_.photographs.cameras.at(CameraId{0}).fx(), 0.7 * 640, 1e-9);
}

TEST_F(IntakeTest, ACopyIsRejectedWithAReason) {
    EXPECT_TRUE(take(message_of("a.jpg", 1)));
    EXPECT_FALSE(take(message_of("b.jpg", 1)));
    EXPECT_NE(told().find("copy of a.jpg"), std::string::npos) << told();
    EXPECT_EQ(outbox_.images_released, 1U);
    EXPECT_EQ(store_->rejected()->size(), 1U);
}

TEST_F(IntakeTest, AKnownNameIsPassedOverAndAnotherPhotographOfItToldOf) {
    EXPECT_TRUE(take(message_of("a.jpg", 1)));
    EXPECT_FALSE(take(message_of("a.jpg", 1)));
    EXPECT_EQ(told(), "");
    EXPECT_FALSE(take(message_of("a.jpg", 2)));
    EXPECT_NE(told().find("another photograph"), std::string::npos) << told();
    EXPECT_EQ(state_.photographs.images.size(), 1U);
}

TEST_F(IntakeTest, WhatIsRefusedByTheSystemIsAskedForAgain) {
    ExtractedMessage message = message_of("a.jpg", 1);
    message.stamp = FileStamp{};
    message.photo = std::make_shared<const Result<ExtractedPhoto>>(
        Error{ErrorCode::kIo, "a.jpg: permission denied"});
    EXPECT_FALSE(take(message));
    ASSERT_EQ(store_->rejected()->size(), 1U);
    EXPECT_EQ(store_->rejected()->front().file_size, -1) << "whatever its stamp is by then";
}

}  // namespace
}  // namespace psfm
