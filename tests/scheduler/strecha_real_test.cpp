// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Photographs with laser-scanned truth (Strecha et al. 2008), progressively, one image after the
// other.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "scheduler/flow/run_session.h"
#include "stages/evaluation/evaluate_model.h"
#include "stages/features/photographs/photo_listing.h"
#include "storage/exchange/models/read_colmap.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

class Nobody final : public SessionObserver {
    void on_publish(const PublishMessage&) override {}
};

struct Scene {
    const char* name;
    std::uint32_t images;
    double known_mm;          ///< mean position error at most, intrinsics known
    double unknown_relative;  ///< RMS over the diagonal at most, nothing known but that the camera
                              ///< is shared
};
void PrintTo(const Scene& scene, std::ostream* out) {
    *out << scene.name;
}

class StrechaRealTest : public testing::TestWithParam<Scene> {
  protected:
    void SetUp() override {
        const char* datasets = std::getenv("PSFM_DATASETS");
        if (datasets == nullptr) GTEST_SKIP() << "PSFM_DATASETS is not set";
        folder_ = fs::path(datasets) / "strecha-half" / GetParam().name;
        if (!fs::exists(folder_)) GTEST_SKIP() << folder_ << " is not there";
        session_ = fs::temp_directory_path() / ("psfm_strecha_" + std::to_string(getpid()));
        fs::remove_all(session_);
    }
    void TearDown() override { fs::remove_all(session_); }

    ModelEvaluation reconstruct(const SessionConfig& config) {
        const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 3);
        auto store = SessionStore::open(session_, {});
        EXPECT_TRUE(store.ok());
        PhotoList photos(list_photos(folder_ / "images")->photos);
        Nobody nobody;
        const std::atomic<bool> stop{false};
        const auto run = run_session(**store, config, {.threads = 2}, photos, nobody, stop);
        EXPECT_TRUE(run.ok());
        EXPECT_EQ(run->counts.placed, GetParam().images);
        EXPECT_EQ(run->counts.effective_clusters, 1U);
        const auto images = (*store)->images();
        std::vector<NamedPose> poses;
        const auto scene = (*store)->scene();
        for (const auto& cluster : scene->clusters) {
            if (!cluster->model) continue;
            for (const RegisteredImage& image : cluster->model->images) {
                poses.push_back(
                    {(*images)[index_of(image.image)].name,
                     transform_pose(image.cam_from_cluster, cluster->world_from_cluster)});
            }
        }
        const auto evaluation = evaluate_model(truth(), poses);
        EXPECT_TRUE(evaluation.ok());
        return evaluation.ok() ? *evaluation : ModelEvaluation{};
    }

    std::vector<NamedPose> truth() const {
        std::vector<NamedPose> poses;
        const auto model = read_colmap_model(
            folder_ / "gt", {.cameras = false, .keypoints = false, .points = false});
        EXPECT_TRUE(model.ok());
        for (const ExportedImage& image : model->images)
            poses.push_back({image.name, image.cam_from_world});
        return poses;
    }

    fs::path folder_;

  private:
    fs::path session_;
};

TEST_P(StrechaRealTest, KnownIntrinsics) {
    SessionConfig config;
    config.deterministic = config.fix_intrinsics = true;
    const auto model = read_colmap_model(folder_ / "gt", {.keypoints = false, .points = false});
    ASSERT_TRUE(model.ok());
    for (const ExportedImage& image : model->images) {
        config.given_cameras[image.name] = {"one", model->find_camera(image.camera_id)->camera};
    }
    EXPECT_LE(1000.0 * reconstruct(config).position_mean, GetParam().known_mm);
}

TEST_P(StrechaRealTest, NothingKnown) {
    SessionConfig config;
    config.deterministic = true;
    config.camera_sharing = CameraSharing::kAll;
    EXPECT_LE(reconstruct(config).position_relative, GetParam().unknown_relative);
}

// Nothing is said of cameras: the photographs show that it is one.
TEST_P(StrechaRealTest, NothingKnownOrSaid) {
    SessionConfig config;
    config.deterministic = true;
    EXPECT_LE(reconstruct(config).position_relative, GetParam().unknown_relative);
}

// What COLMAP 3.8 reaches on the same photographs, and a tenth (scenes of docs/datasets.md).
INSTANTIATE_TEST_SUITE_P(Scenes, StrechaRealTest,
                         testing::Values(Scene{"Herz-Jesus-P8", 8, 4.0, 0.00055},
                                         Scene{"fountain-P11", 11, 3.0, 0.00045},
                                         Scene{"entry-P10", 10, 10.3, 0.00077},
                                         Scene{"castle-P19", 19, 95.0, 0.0036}));

}  // namespace
}  // namespace psfm
