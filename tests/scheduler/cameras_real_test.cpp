// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Photographs whose cameras have to be found: without EXIF, or with EXIF that misleads.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "scheduler/flow/run_session.h"
#include "scheduler/report/camera_report.h"
#include "stages/evaluation/evaluate_model.h"
#include "stages/features/photographs/photo_listing.h"
#include "storage/exchange/models/read_colmap.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

class Nobody final : public SessionObserver {
    void on_publish(const PublishMessage&) override {}
};

class CamerasRealTest : public testing::Test {
  protected:
    void SetUp() override {
        const char* datasets = std::getenv("PSFM_DATASETS");
        if (datasets == nullptr) GTEST_SKIP() << "PSFM_DATASETS is not set";
        datasets_ = datasets;
        session_ = fs::temp_directory_path() / ("psfm_cameras_" + std::to_string(getpid()));
        fs::remove_all(session_);
    }
    void TearDown() override { fs::remove_all(session_); }

    void reconstruct(const fs::path& photographs, CameraSharing sharing = CameraSharing::kAuto) {
        if (!fs::exists(photographs)) GTEST_SKIP() << photographs << " is not there";
        const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 3);
        auto store = SessionStore::open(session_, {});
        ASSERT_TRUE(store.ok());
        PhotoList photos(list_photos(photographs)->photos);
        Nobody nobody;
        const std::atomic<bool> stop{false};
        SessionConfig config;
        config.deterministic = true;
        config.camera_sharing = sharing;
        const auto run = run_session(**store, config, {.threads = 2}, photos, nobody, stop);
        ASSERT_TRUE(run.ok());
        placed_ = run->counts.placed;
        EXPECT_EQ(run->counts.effective_clusters, 1U);
        const auto images = (*store)->images();
        const auto scene = (*store)->scene();
        cameras_ = report_cameras(*scene, *images);
        for (const auto& cluster : scene->clusters) {
            if (!cluster->model) continue;
            for (const RegisteredImage& image : cluster->model->images) {
                poses_.push_back(
                    {(*images)[index_of(image.image)].name,
                     transform_pose(image.cam_from_cluster, cluster->world_from_cluster)});
            }
        }
    }

    ModelEvaluation against(const std::vector<NamedPose>& reference) const {
        const auto evaluation = evaluate_model(reference, poses_);
        EXPECT_TRUE(evaluation.ok());
        return evaluation.ok() ? *evaluation : ModelEvaluation{};
    }

    static std::vector<NamedPose> truth(const fs::path& model) {
        std::vector<NamedPose> poses;
        const auto read =
            read_colmap_model(model, {.cameras = false, .keypoints = false, .points = false});
        EXPECT_TRUE(read.ok());
        for (const ExportedImage& image : read->images)
            poses.push_back({image.name, image.cam_from_world});
        return poses;
    }

    /// Lines "photograph x y z": no orientations.
    static std::vector<NamedPose> centres(const fs::path& file) {
        std::vector<NamedPose> poses;
        std::ifstream stream(file);
        for (std::string line; std::getline(stream, line);) {
            std::istringstream fields(line);
            NamedPose pose;
            Eigen::Vector3d centre;
            if (line.starts_with('#') ||
                !(fields >> pose.name >> centre.x() >> centre.y() >> centre.z()))
                continue;
            pose.cam_from_world.translation = -centre;
            poses.push_back(pose);
        }
        return poses;
    }

    /// Root mean square distance from the mean.
    static double extent(const std::vector<NamedPose>& poses) {
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (const NamedPose& pose : poses) mean += pose.cam_from_world.target_origin_in_source();
        mean /= static_cast<double>(poses.size());
        double sum = 0.0;
        for (const NamedPose& pose : poses)
            sum += (pose.cam_from_world.target_origin_in_source() - mean).squaredNorm();
        return std::sqrt(sum / static_cast<double>(poses.size()));
    }

    fs::path datasets_;
    std::uint32_t placed_ = 0;
    std::vector<NamedPose> poses_;
    std::vector<CameraReport> cameras_;

  private:
    fs::path session_;
};

// A plane from above hardly tells focal lengths: a few wrong observations bent it, and photographs
// left the camera of the others.
TEST_F(CamerasRealTest, AFlightOverFlatLandWithoutExif) {
    reconstruct(datasets_ / "cases" / "noexif-nadir");
    if (IsSkipped()) return;
    const ModelEvaluation evaluation = against(truth(datasets_ / "cases" / "noexif-nadir-gt"));
    EXPECT_EQ(placed_, 15U);
    EXPECT_LT(evaluation.position_relative, 0.002);  // 0.0004
    EXPECT_EQ(evaluation.outliers, 0U);
    EXPECT_EQ(cameras_.size(), 1U);
}

TEST_F(CamerasRealTest, DigitalZoom) {
    reconstruct(datasets_ / "cases" / "digital-zoom");
    if (IsSkipped()) return;
    EXPECT_EQ(placed_, 11U);
    const ModelEvaluation evaluation =
        against(truth(datasets_ / "strecha-half" / "fountain-P11" / "gt"));
    EXPECT_LT(evaluation.position_relative, 0.002);  // 0.001 by a camera for each photograph
    EXPECT_EQ(cameras_.size(), 2U);
}

TEST_F(CamerasRealTest, ARobotsCameraWithoutExif) {
    reconstruct(datasets_ / "real" / "multicam" / "images");
    if (IsSkipped()) return;
    EXPECT_EQ(placed_, 39U);
    const std::vector<NamedPose> reference =
        centres(datasets_ / "real" / "multicam" / "centres.txt");
    const ModelEvaluation evaluation = against(reference);
    EXPECT_LE(evaluation.position_median, 0.0045 * extent(reference));
    for (const ImageError& image : evaluation.images)
        EXPECT_LE(image.position, 0.02 * extent(reference)) << image.name;
    EXPECT_EQ(cameras_.size(), 1U);
}

}  // namespace
}  // namespace psfm
