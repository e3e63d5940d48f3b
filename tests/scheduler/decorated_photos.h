// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "scheduler/flow/run_session.h"
#include "stages/evaluation/evaluate_model.h"
#include "stages/features/photographs/photo_listing.h"
#include "tests/synthetic/photographs/paint.h"
#include "tests/synthetic/photographs/photograph.h"
#include "tests/synthetic/rng.h"

namespace psfm {

/// Photographs with something in them that the scene has not, and sessions of them.
class DecoratedPhotos : public testing::Test {
  protected:
    static constexpr std::uint32_t kWidth = 640;
    static constexpr std::uint32_t kHeight = 480;

    struct Shot {
        std::string name;
        Rigid3 cam_from_world;
    };
    /// Changes photograph number i.
    using Decorate = std::function<void(cv::Mat&, std::size_t)>;

    void SetUp() override {
        folder_ =
            std::filesystem::temp_directory_path() / ("psfm_decorated_" + std::to_string(getpid()));
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_ / "images");
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    static Camera camera() { return make_camera(kWidth, kHeight, 560.0, FocalSource::kGiven); }

    void take(const synthetic::PhotoWorld& world, const std::vector<Shot>& shots,
              const Decorate& decorate) {
        const synthetic::SightLines sight = synthetic::make_sight_lines(camera());
        tbb::parallel_for(std::size_t{0}, shots.size(), [&](std::size_t i) {
            const std::uint64_t seed = synthetic::mix_seed(77, truth_.size() + i);
            cv::Mat image =
                synthetic::take_photograph(world, sight, shots[i].cam_from_world, {}, seed);
            decorate(image, i);
            cv::imwrite((folder_ / "images" / shots[i].name).string(), image,
                        {cv::IMWRITE_JPEG_QUALITY, 90});
        });
        for (const Shot& shot : shots) truth_.push_back({shot.name, shot.cam_from_world});
    }

    /// Puts a picture over a photograph.
    static void put(cv::Mat& image, const cv::Mat& picture, int left, int top) {
        picture.copyTo(image(cv::Rect(left, top, picture.cols, picture.rows)));
    }
    static cv::Mat picture(int width, int height, std::uint64_t seed) {
        return synthetic::paint_texture({width, height}, 200.0, synthetic::Paint::kPlaster, seed);
    }

    struct Outcome {
        SessionRun run;
        std::vector<std::vector<NamedPose>> parts;  ///< effective clusters, largest first
        std::map<std::string, WaitReason> waiting;
    };

    /// @param known  intrinsics are given; else nothing is known of them
    Outcome reconstruct(bool known) {
        const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 3);
        SessionConfig config;
        config.deterministic = true;
        if (known) {
            for (const NamedPose& photo : truth_)
                config.given_cameras[photo.name] = {"one", camera()};
        }
        std::filesystem::remove_all(folder_ / "session");
        auto store = SessionStore::open(folder_ / "session", {});
        EXPECT_TRUE(store.ok());
        PhotoList photos(list_photos(folder_ / "images")->photos);
        Nobody nobody;
        const std::atomic<bool> stop{false};
        auto run = run_session(**store, config, {.threads = 2}, photos, nobody, stop);
        EXPECT_TRUE(run.ok());
        Outcome outcome{*std::move(run), {}, {}};
        outcome.waiting.insert(outcome.run.waiting.begin(), outcome.run.waiting.end());
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

    /// RMS position error of a part over the truth's extent.
    double relative_error(const std::vector<NamedPose>& part) const {
        const auto evaluation = evaluate_model(truth_, part);
        EXPECT_TRUE(evaluation.ok());
        return evaluation.ok() ? evaluation->position_relative : 1.0;
    }

    std::filesystem::path folder_;
    std::vector<NamedPose> truth_;

  private:
    class Nobody final : public SessionObserver {
        void on_publish(const PublishMessage& /*publish*/) override {}
    };
};

}  // namespace psfm
