// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/session_config.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

TEST(SessionConfig, SurvivesItsEncoding) {
    SessionConfig config;
    config.preset = "paper";
    config.camera_sharing = CameraSharing::kFolder;
    config.fix_intrinsics = config.deterministic = true;
    config.seed = 0xFFFFFFFFFFFFFFFFULL;
    config.vocabulary_file = "/words";
    config.order = {"b.jpg", "a.jpg"};
    config.history = History::kFull;
    config.memory_mib = 700;
    config.anchors = {{ImageId{4}, Rigid3{Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {1, 2, 3.25}}}};
    config.given_cameras["a.jpg"] = {"key", make_camera(100, 80, 90.25, FocalSource::kGiven)};
    const auto back = decode_config(encode_config(config));
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(back->preset, "paper");
    EXPECT_EQ(back->camera_sharing, CameraSharing::kFolder);
    EXPECT_TRUE(back->fix_intrinsics && back->deterministic && !back->batch);
    EXPECT_EQ(back->seed, config.seed);
    EXPECT_EQ(back->order, config.order);
    EXPECT_EQ(back->history, History::kFull);
    EXPECT_EQ(back->memory_mib, 700U);
    ASSERT_EQ(back->anchors.size(), 1U);
    EXPECT_EQ(back->anchors[0].image, ImageId{4});
    const Rigid3& anchor = back->anchors[0].cam_from_world;
    EXPECT_EQ(anchor.rotation.coeffs(), config.anchors[0].cam_from_world.rotation.coeffs());
    EXPECT_EQ(anchor.translation, config.anchors[0].cam_from_world.translation);
    EXPECT_EQ(back->given_cameras.at("a.jpg").camera, config.given_cameras.at("a.jpg").camera);
    EXPECT_EQ(back->given_cameras.at("a.jpg").key, "key");
}

TEST(SessionConfig, OfEarlierProgramsHasTheMemoryThatIsUsual) {
    std::string text = encode_config(SessionConfig{});
    const std::string field = "\"memory_mib\":1536,";
    const std::size_t at = text.find(field);
    ASSERT_NE(at, std::string::npos) << text;
    text.erase(at, field.size());
    const auto back = decode_config(text);
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(back->memory_mib, 1536U);
}

TEST(SessionConfig, RefusesDamageAndNewerPrograms) {
    EXPECT_EQ(decode_config("{").error().code, ErrorCode::kDamaged);
    EXPECT_EQ(decode_config("{\"version\":1}").error().code, ErrorCode::kDamaged);
    EXPECT_EQ(decode_config("{\"version\":99}").error().code, ErrorCode::kVersion);
}

TEST(StageOptions, PaperPresetSetsThePapersFormula) {
    SessionConfig config;
    ASSERT_TRUE(stage_options(config).ok());
    EXPECT_EQ(stage_options(config)->clustering.form, JaccardForm::kMutual);
    config.preset = "paper";
    EXPECT_EQ(stage_options(config)->clustering.form, JaccardForm::kLiteral);
    EXPECT_EQ(stage_options(config)->clustering.join_up_to, 0U) << "nothing is held apart";
    EXPECT_EQ(stage_options(config)->solve.max_reset_images, 0.0) << "whole clusters only";
    EXPECT_GT(stage_options(config)->solve.policy.large_from, 1000000U) << "no parts of them";
    EXPECT_FALSE(stage_options(config)->solve.plausibility) << "inliers alone";
    EXPECT_GT(stage_options(config)->solve.policy.converge_up_to, 1000000U)
        << "to the end, all of it";
    EXPECT_GT(stage_options(config)->solve.policy.affordable_up_to, 1000000U);
    config.preset = "other";
    EXPECT_EQ(stage_options(config).error().code, ErrorCode::kInvalidArgument);
}

TEST(StageOptions, AreValid) {
    for (const char* preset : {"default", "paper"}) {
        SCOPED_TRACE(preset);
        SessionConfig config;
        config.preset = preset;
        const auto options = stage_options(config);
        ASSERT_TRUE(options.ok());
        EXPECT_TRUE(validate(options->solve).ok());
        EXPECT_TRUE(validate(options->clustering).ok());
        EXPECT_TRUE(validate(options->merge).ok());
        EXPECT_TRUE(validate(options->retrieval).ok());
        EXPECT_TRUE(validate(options->verification).ok());
        EXPECT_TRUE(validate(options->features).ok());
    }
}

TEST(SessionConfig, NumbersOutOfRangeAreDamage) {
    const std::string text = encode_config(SessionConfig{});
    for (const char* value : {"1e300", "-1", "1.5", "18446744073709551616", "\"1\""}) {
        for (const std::string field : {"\"version\":1", "\"seed\":0"}) {
            std::string changed = text;
            const std::size_t at = changed.find(field);
            ASSERT_NE(at, std::string::npos);
            changed.replace(at + field.size() - 1, 1, value);
            ASSERT_FALSE(decode_config(changed).ok()) << changed;
            EXPECT_EQ(decode_config(changed).error().code, ErrorCode::kDamaged);
        }
    }
}

}  // namespace
}  // namespace psfm
