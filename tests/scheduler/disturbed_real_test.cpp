// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What users' photographs do (datasets/cases), judged by what the scene gives without it.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <set>

#include "scheduler/flow/run_session.h"
#include "stages/evaluation/evaluate_model.h"
#include "stages/features/photographs/photo_listing.h"
#include "storage/exchange/models/read_colmap.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

class Nobody final : public SessionObserver {
    void on_publish(const PublishMessage& /*publish*/) override {}
};

class DisturbedRealTest : public testing::Test {
  protected:
    void SetUp() override {
        const char* datasets = std::getenv("PSFM_DATASETS");
        if (datasets == nullptr) GTEST_SKIP() << "PSFM_DATASETS is not set";
        datasets_ = datasets;
        session_ = fs::temp_directory_path() / ("psfm_disturbed_" + std::to_string(getpid()));
        fs::remove_all(session_);
    }
    void TearDown() override { fs::remove_all(session_); }

    struct Outcome {
        SessionRun run;
        std::vector<std::vector<NamedPose>> parts;  ///< effective clusters, largest first
    };

    Outcome reconstruct(const std::string& name, const SessionConfig& config) {
        const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 3);
        auto store = SessionStore::open(session_, {});
        EXPECT_TRUE(store.ok());
        PhotoList photos(list_photos(datasets_ / "cases" / name)->photos);
        Nobody nobody;
        const std::atomic<bool> stop{false};
        auto run = run_session(**store, config, {.threads = 2}, photos, nobody, stop);
        EXPECT_TRUE(run.ok());
        Outcome outcome{*std::move(run), {}};
        const auto images = (*store)->images();
        const auto scene = (*store)->scene();
        outcome.parts.resize(scene->effective_clusters);
        for (const auto& cluster : scene->clusters) {
            if (!cluster->model) continue;
            for (const RegisteredImage& image : cluster->model->images) {
                outcome.parts[cluster->effective_cluster].push_back(
                    {(*images)[index_of(image.image)].name,
                     transform_pose(image.cam_from_cluster, cluster->world_from_cluster)});
            }
        }
        return outcome;
    }

    /// Of fountain-P11, by the names of the cases.
    std::vector<NamedPose> fountain(const std::string& prefix) const {
        std::vector<NamedPose> poses;
        const auto model =
            read_colmap_model(datasets_ / "strecha-half/fountain-P11/gt",
                              {.cameras = false, .keypoints = false, .points = false});
        EXPECT_TRUE(model.ok());
        for (const ExportedImage& image : model->images)
            poses.push_back(
                {prefix + fs::path(image.name).stem().string() + ".jpg", image.cam_from_world});
        return poses;
    }

    fs::path datasets_;

  private:
    fs::path session_;
};

TEST_F(DisturbedRealTest, AHoodDoesNotBendTheScene) {
    SessionConfig config;
    config.deterministic = true;
    const Outcome outcome = reconstruct("static-foreground-15", config);
    ASSERT_FALSE(outcome.parts.empty());
    EXPECT_EQ(outcome.parts.front().size(), 11U);
    const auto evaluation = evaluate_model(fountain(""), outcome.parts.front());
    ASSERT_TRUE(evaluation.ok());
    EXPECT_LT(evaluation->position_relative, 0.01);
    EXPECT_EQ(evaluation->outliers, 0U);
}

TEST_F(DisturbedRealTest, TwoScenesWithOneWatermarkAreTwoModels) {
    SessionConfig config;
    config.deterministic = true;
    const Outcome outcome = reconstruct("shared-watermark-two-scenes", config);
    ASSERT_EQ(outcome.parts.size(), 2U);
    for (const auto& part : outcome.parts) {
        EXPECT_EQ(part.size(), 11U);
        std::set<bool> scenes;
        for (const NamedPose& photo : part) scenes.insert(photo.name.starts_with("kermit"));
        EXPECT_EQ(scenes.size(), 1U);
        if (part.front().name.starts_with("kermit")) continue;
        const auto evaluation = evaluate_model(fountain("a_"), part);
        ASSERT_TRUE(evaluation.ok());
        EXPECT_LT(evaluation->position_relative, 0.01);
    }
}

TEST_F(DisturbedRealTest, APanoramaHasNoDepth) {
    SessionConfig config;
    config.deterministic = true;
    const Outcome outcome = reconstruct("panorama", config);
    EXPECT_EQ(outcome.run.counts.placed, 0U);
    ASSERT_EQ(outcome.run.waiting.size(), 14U);
    for (const auto& [name, reason] : outcome.run.waiting)
        EXPECT_EQ(reason, WaitReason::kNoParallax) << name;
}

}  // namespace
}  // namespace psfm
