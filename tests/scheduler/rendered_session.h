// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "graph/reconstruction.h"
#include "scheduler/flow/run_session.h"
#include "stages/features/photographs/photo_listing.h"
#include "tests/synthetic/photographs/render.h"

namespace psfm {

/// Keeps all that a session tells.
class Recorder final : public SessionObserver {
  public:
    void on_publish(const PublishMessage& publish) override {
        images.insert(images.end(), publish.images.begin(), publish.images.end());
        events.insert(events.end(), publish.events.begin(), publish.events.end());
        if (publish.scene) versions.push_back(publish.scene);
        if (stop_after > 0 && images.size() >= stop_after) stop.store(true);
    }
    std::vector<ImageReport> images;
    std::vector<SessionEvent> events;
    std::vector<ScenePtr> versions;
    std::size_t stop_after = 0;
    std::atomic<bool> stop{false};
};

/// Sessions of nine photographs of a wall, which are rendered once.
class RenderedSession : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder = std::filesystem::temp_directory_path() /
                 ("psfm_run_session_" + std::to_string(getpid()));
        synthetic::PhotoSetOptions options;
        options.scene = synthetic::PhotoScene::kWall;
        options.images = 9;
        options.width = 480;
        options.height = 360;
        ASSERT_TRUE(synthetic::render_photographs(options, 11, folder / "photos").ok());
    }
    static void TearDownTestSuite() { std::filesystem::remove_all(folder); }

    static std::filesystem::path images() { return folder / "photos" / "images"; }
    static std::filesystem::path fresh(const std::string& name) {
        std::filesystem::remove_all(folder / name);
        return folder / name;
    }
    static std::vector<PhotoFile> photos() { return list_photos(images())->photos; }

    struct Outcome {
        Result<SessionRun> run = Error{};
        Recorder recorder;
    };

    static void run(const std::filesystem::path& session, const SessionConfig& config,
                    std::vector<PhotoFile> files, Outcome& outcome, int threads = 2,
                    ExecutionOptions execution = {}) {
        const tbb::global_control workers(tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(threads) + 1);
        auto store = SessionStore::open(session, {});
        ASSERT_TRUE(store.ok()) << store.error().message;
        PhotoList list(std::move(files));
        execution.threads = threads;
        outcome.run =
            run_session(**store, config, execution, list, outcome.recorder, outcome.recorder.stop);
        ASSERT_TRUE(outcome.run.ok()) << outcome.run.error().message;
    }

    static Scene scene_of(const std::filesystem::path& session) {
        auto reader = open_session_reader(session, {});
        EXPECT_TRUE(reader.ok());
        auto scene = (*reader)->scene();
        EXPECT_TRUE(scene.ok());
        return *scene;
    }

    /// Bitwise, points and poses.
    static void expect_equal(const Scene& a, const Scene& b) {
        ASSERT_EQ(a.clusters.size(), b.clusters.size());
        for (std::size_t c = 0; c < a.clusters.size(); ++c) {
            EXPECT_EQ(a.clusters[c]->members, b.clusters[c]->members);
            EXPECT_EQ(a.clusters[c]->world_from_cluster.translation,
                      b.clusters[c]->world_from_cluster.translation);
            EXPECT_EQ(a.clusters[c]->world_from_cluster.scale,
                      b.clusters[c]->world_from_cluster.scale);
            const Reconstruction& model_a = *a.clusters[c]->model;
            const Reconstruction& model_b = *b.clusters[c]->model;
            ASSERT_EQ(model_a.images.size(), model_b.images.size());
            for (std::size_t i = 0; i < model_a.images.size(); ++i) {
                EXPECT_EQ(model_a.images[i].cam_from_cluster.translation,
                          model_b.images[i].cam_from_cluster.translation);
                EXPECT_EQ(model_a.images[i].cam_from_cluster.rotation.coeffs(),
                          model_b.images[i].cam_from_cluster.rotation.coeffs());
            }
            ASSERT_EQ(model_a.points.size(), model_b.points.size());
            for (std::size_t i = 0; i < model_a.points.size(); ++i) {
                ASSERT_EQ(model_a.points[i].position, model_b.points[i].position);
                ASSERT_EQ(model_a.points[i].track, model_b.points[i].track);
            }
        }
    }

    inline static std::filesystem::path folder;
};

}  // namespace psfm
