// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// `psfm export` and `psfm evaluate` on a session whose every figure is known beforehand.
#include <gtest/gtest.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <nlohmann/json.hpp>

#include "storage/exchange/models/read_colmap.h"
#include "storage/session/session_store.h"
#include "tests/stages/evaluation/pose_lists.h"
#include "tests/storage/exchange/example_model.h"
#include "tools/commands/commands.h"

namespace psfm {
namespace {

using Json = nlohmann::json;

constexpr std::uint32_t kImages = 14;
constexpr std::uint32_t kFeatures = 6;

struct Outcome {
    int exit_code = 0;
    std::string output;
    std::string errors;
};

/// What tools/main.cpp does with an argument list.
Outcome run(std::vector<std::string> arguments) {
    CLI::App app{"psfm"};
    app.require_subcommand(1);
    Outcome outcome;
    add_run_command(app, outcome.exit_code);
    add_export_command(app, outcome.exit_code);
    add_evaluate_command(app, outcome.exit_code);
    std::ranges::reverse(arguments);  // CLI11 takes them from the back
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    try {
        app.parse(arguments);
    } catch (const CLI::ParseError& error) {
        outcome.exit_code = app.exit(error) == 0 ? 0 : 2;
    }
    outcome.output = testing::internal::GetCapturedStdout();
    outcome.errors = testing::internal::GetCapturedStderr();
    return outcome;
}

/// A reference of 14 cameras, and a session that has seen 14 images. After six of them one cluster
/// held all; at the end cluster 0 holds images 0 to 8 and cluster 1 images 9 to 13, each in a gauge
/// of its own, joined into one effective cluster, in which camera 3 is 3 m off.
class SessionCommands : public testing::Test {
  protected:
    void SetUp() override {
        write_reference();
        auto opened = SessionStore::open(session(), {});
        ASSERT_TRUE(opened.ok()) << opened.error().message;
        store_ = *std::move(opened);
        ASSERT_TRUE(store_->put_settings({"/photos", "{}"}).ok());
    }

    std::string session() const { return (folder_.path() / "session").string(); }
    std::string reference() const { return (folder_.path() / "reference").string(); }
    std::string output(const std::string& name) const { return (folder_.path() / name).string(); }

    void write_reference() {
        std::ostringstream images;
        images << std::setprecision(17);
        for (std::size_t i = 0; i < truth_.size(); ++i) {
            const Rigid3& pose = truth_[i].cam_from_world;
            images << i + 1 << ' ' << pose.rotation.w() << ' ' << pose.rotation.x() << ' '
                   << pose.rotation.y() << ' ' << pose.rotation.z() << ' ' << pose.translation.x()
                   << ' ' << pose.translation.y() << ' ' << pose.translation.z() << " 1 "
                   << truth_[i].name << "\n\n";
        }
        test::put_file(folder_.path() / "reference" / "images.txt", images.str());
    }

    void accept_images(std::uint32_t first, std::uint32_t end) {
        for (std::uint32_t i = first; i < end; ++i) {
            Image image;
            image.id = static_cast<ImageId>(i);
            image.name = truth_[i].name;
            image.metadata.width = 1000;
            image.metadata.height = 800;
            Keypoints keypoints(kFeatures);
            for (std::uint32_t k = 0; k < kFeatures; ++k) {
                keypoints[k] = {static_cast<float>(k), 2.5F, 1.F, 0.F, 200, 100, 50};
            }
            const Descriptors descriptors{
                std::vector<std::uint8_t>(kFeatures * Descriptors::kSize)};
            ASSERT_TRUE(store_->commit_image(image, camera_, keypoints, descriptors).ok());
            ASSERT_TRUE(store_->commit_pairs(image.id, {}, {}, {}).ok());
        }
    }

    /// Solves images first … end - 1 as one cluster in another gauge. @return its placement
    StoredPlacement solve(std::uint32_t id, std::uint32_t revision, std::uint32_t first,
                          std::uint32_t end) {
        StoredPlacement placement;
        placement.cluster = static_cast<ClusterId>(id);
        placement.revision = revision;
        placement.world_from_cluster = test::some_similarity(100 * revision + id);
        auto model = std::make_shared<Reconstruction>();
        model->cameras[CameraId{0}] = camera_;
        ScenePoint point;
        for (std::uint32_t i = first; i < end; ++i) {
            NamedPose pose = truth_[i];
            if (i == 3) test::shift_centre(pose, {0, 3, 0});
            const Rigid3 cam_from_cluster =
                transform_pose(pose.cam_from_world, inverse(placement.world_from_cluster));
            model->images.push_back({static_cast<ImageId>(i), CameraId{0}, cam_from_cluster});
            point.track.push_back({static_cast<ImageId>(i), id + 1});
            placement.members.push_back(static_cast<ImageId>(i));
        }
        model->points = std::vector{point};
        StoredCluster cluster{
            placement.cluster, placement.members, revision, revision, revision, 0, {}, {}};
        EXPECT_TRUE(
            store_->commit_solution({placement.cluster, revision, model, "{}"}, cluster, {}).ok());
        return placement;
    }

    void publish(std::uint64_t version, std::uint32_t image_count,
                 std::vector<StoredPlacement> placements) {
        StoredSceneVersion scene;
        scene.version = version;
        scene.image_count = image_count;
        scene.effective_clusters = placements.empty() ? 0 : 1;
        scene.placements = std::move(placements);
        scene.summary_json = "{}";
        const auto committed = store_->commit_scene(scene, {});
        ASSERT_TRUE(committed.ok()) << committed.error().message;
    }

    void fill() {
        accept_images(0, 6);
        publish(1, 6, {solve(0, 1, 0, 6)});
        accept_images(6, kImages);
        publish(2, kImages, {solve(0, 2, 0, 9), solve(1, 1, 9, kImages)});
    }

    test::TemporaryFolder folder_;
    std::vector<NamedPose> truth_ = test::grid_poses(kImages, 5);
    Camera camera_ = make_camera(1000, 800, 900, FocalSource::kExif);
    std::unique_ptr<SessionStore> store_;
};

TEST_F(SessionCommands, FiguresAreTheKnownOnes) {
    fill();
    const Outcome outcome =
        run({"evaluate", "--reference", reference(), "--session", session(), "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    const Json json = Json::parse(outcome.output);
    ASSERT_EQ(json["models"].size(), 1U);
    const Json& model = json["models"][0];
    EXPECT_EQ(model["registered"], kImages);
    EXPECT_EQ(model["points"], 2);
    EXPECT_EQ(model["outliers"], 1);
    EXPECT_NEAR(model["ate_mean"].get<double>(), 3.0 / kImages, 1e-6);
    EXPECT_NEAR(model["ate_rmse"].get<double>(), 3.0 / std::sqrt(kImages), 1e-6);
    EXPECT_NEAR(model["ate_median"].get<double>(), 0.0, 1e-6);
    EXPECT_LT(model["rot_max_deg"].get<double>(), 1e-4);
    EXPECT_GT(model["ate_rel"].get<double>(), 0.0);
    EXPECT_TRUE(model.contains("rot_median_deg"));
    // 13 of 91 pairs have the shifted camera.
    EXPECT_GE(json["auc"]["1"].get<double>(), 78.0 / 91.0 - 1e-4);
    EXPECT_LT(json["auc"]["10"].get<double>(), 80.0 / 91.0);
    EXPECT_EQ(json["auc"].size(), 4U);
    EXPECT_FALSE(json.contains("versions"));
}

TEST_F(SessionCommands, ExportedModelsHaveTheSameFigures) {
    fill();
    const Json of_session = Json::parse(
        run({"evaluate", "--reference", reference(), "--session", session(), "--json"}).output);
    for (const std::string format : {"colmap", "colmap-text"}) {
        const Outcome exported =
            run({"export", "--session", session(), "--format", format, "--output", output(format)});
        ASSERT_EQ(exported.exit_code, 0) << exported.errors;
        EXPECT_NE(exported.output.find("14 images, 2 points"), std::string::npos)
            << exported.output;
        Json of_export = Json::parse(
            run({"evaluate", "--reference", reference(), output(format), "--json"}).output);
        EXPECT_EQ(of_export["auc"], of_session["auc"]);
        of_export["models"][0]["model"] = of_session["models"][0]["model"];
        EXPECT_EQ(of_export["models"], of_session["models"]);
        const auto model = read_colmap_model(folder_.path() / format / "0");
        ASSERT_TRUE(model.ok()) << model.error().message;
        EXPECT_EQ(model->points[1].track.size(), 5U);
        EXPECT_EQ(model->points[1].rgb, (std::array<std::uint8_t, 3>{200, 100, 50}));
        EXPECT_EQ(model->images[0].keypoints.size(), kFeatures);
        EXPECT_EQ(model->images[0].name, truth_[0].name);
    }
}

TEST_F(SessionCommands, EveryImageListsTheKeptVersions) {
    fill();
    const Outcome outcome = run({"evaluate", "--reference", reference(), "--session", session(),
                                 "--every-image", "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    const Json versions = Json::parse(outcome.output)["versions"];
    ASSERT_EQ(versions.size(), 2U);
    EXPECT_EQ(versions[0]["image"], 6);
    EXPECT_EQ(versions[0]["placed"], 6);
    EXPECT_EQ(versions[0]["effective_clusters"], 1);
    EXPECT_EQ(versions[0]["outliers"], 1);
    EXPECT_EQ(versions[0]["largest"]["registered"], 6);
    EXPECT_EQ(versions[1]["image"], kImages);
    EXPECT_EQ(versions[1]["largest"]["outliers"], 1);
    const Outcome table =
        run({"evaluate", "--reference", reference(), "--session", session(), "--every-image"});
    EXPECT_EQ(table.exit_code, 0);
    EXPECT_NE(table.output.find("versions"), std::string::npos);
    EXPECT_NE(table.output.find("AUC"), std::string::npos);
}

TEST_F(SessionCommands, ExportOfAnEarlierVersion) {
    fill();
    const Outcome outcome = run({"export", "--session", session(), "--format", "colmap", "--output",
                                 output("early"), "--after-image", "9"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_EQ(read_colmap_model(folder_.path() / "early" / "0")->images.size(), 6U);
    EXPECT_EQ(run({"export", "--session", session(), "--format", "ply", "--output", output("early"),
                   "--after-image", "2"})
                  .exit_code,
              3);
}

TEST_F(SessionCommands, EveryFormatIsWritten) {
    fill();
    const std::vector<std::pair<std::string, std::string>> files{
        {"colmap", "0/points3D.bin"},
        {"colmap-text", "0/points3D.txt"},
        {"ply", "0.ply"},
        {"nvm", "0.nvm"},
        {"bundler", "0/bundle.out"},
        {"nerfstudio", "0/transforms.json"},
        {"gltf", "0.gltf"}};
    for (const auto& [format, file] : files) {
        const Outcome outcome =
            run({"export", "--session", session(), "--format", format, "--output", output(format)});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
        EXPECT_TRUE(std::filesystem::exists(folder_.path() / format / file)) << file;
    }
    const Json json =
        Json::parse(test::file_bytes(folder_.path() / "nerfstudio/0/transforms.json"));
    EXPECT_EQ(json["frames"][0]["file_path"], "images/" + truth_[0].name);
}

TEST_F(SessionCommands, SessionWithoutAModel) {
    accept_images(0, 1);
    publish(1, 1, {});
    const Outcome exported =
        run({"export", "--session", session(), "--format", "colmap", "--output", output("x")});
    EXPECT_EQ(exported.exit_code, 3);
    EXPECT_NE(exported.errors.find("has no model yet: 1 image waiting"), std::string::npos)
        << exported.errors;
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "x"));
    const Outcome evaluated = run({"evaluate", "--reference", reference(), "--session", session()});
    EXPECT_EQ(evaluated.exit_code, 3);
    EXPECT_NE(evaluated.errors.find("has no model yet: 1 image waiting"), std::string::npos);
}

TEST_F(SessionCommands, NothingIsExportedIntoTheSession) {
    fill();
    std::filesystem::create_directory_symlink(folder_.path(), folder_.path() / "around");
    const auto below = std::filesystem::path(session()).filename() / "a" / "b";
    for (const std::string& place : {session(), session() + "/", session() + "/a/../b",
                                     output("around") + "/" + below.string()}) {
        for (const char* format : {"colmap", "dataset", "colmap-database"}) {
            const Outcome refused =
                run({"export", "--session", session(), "--format", format, "--output", place});
            EXPECT_EQ(refused.exit_code, 3) << place;
            EXPECT_NE(refused.errors.find(place + " is the session " + session()),
                      std::string::npos)
                << refused.errors;
        }
    }
    EXPECT_EQ(run({"run", folder_.path().string(), "--session", session(), "--dataset", session()})
                  .exit_code,
              3);
    EXPECT_FALSE(std::filesystem::exists(session() + "/b"));
    // A name that only begins alike is another folder.
    EXPECT_EQ(
        run({"export", "--session", session(), "--format", "ply", "--output", session() + "2"})
            .exit_code,
        0);
}

TEST_F(SessionCommands, BadInputAndUsage) {
    EXPECT_EQ(
        run({"export", "--session", output("none"), "--format", "ply", "--output", output("x")})
            .exit_code,
        3);
    EXPECT_EQ(run({"export", "--session", session(), "--format", "obj", "--output", output("x")})
                  .exit_code,
              2);
    EXPECT_EQ(run({"export", "--session", session(), "--format", "ply"}).exit_code, 2);
    EXPECT_EQ(run({"evaluate", "--reference", output("none"), reference()}).exit_code, 3);
    EXPECT_EQ(run({"evaluate", "--reference", reference(), output("none")}).exit_code, 3);
    EXPECT_EQ(run({"evaluate", "--reference", reference()}).exit_code, 2);
    EXPECT_EQ(run({"evaluate", "--reference", reference(), reference(), "--every-image"}).exit_code,
              2);
    EXPECT_EQ(run({"evaluate", "--reference", reference(), reference(), "--session", session()})
                  .exit_code,
              2);
    test::put_file(folder_.path() / "damaged" / "images.txt", "1 2 3\n");
    const Outcome damaged = run({"evaluate", "--reference", reference(), output("damaged")});
    EXPECT_EQ(damaged.exit_code, 3);  // an input is damaged, no store is
    EXPECT_NE(damaged.errors.find("images.txt, line 1"), std::string::npos);
}

TEST_F(SessionCommands, ModelsThatCannotBeJudgedAreNull) {
    test::put_file(folder_.path() / "both" / "0" / "images.txt",
                   test::file_bytes(folder_.path() / "reference" / "images.txt"));
    test::put_file(folder_.path() / "both" / "1" / "images.txt", "1 1 0 0 0 0 0 0 1 other.jpg\n\n");
    const Outcome outcome = run({"evaluate", "--reference", reference(), output("both"), "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    const Json json = Json::parse(outcome.output);
    EXPECT_EQ(json["models"][0]["outliers"], 0);
    EXPECT_TRUE(json["models"][1]["ate_mean"].is_null());
    EXPECT_TRUE(json["models"][1]["error"].is_string());
    EXPECT_NEAR(json["auc"]["1"].get<double>(), 1.0, 1e-5);
    const Outcome alone =
        run({"evaluate", "--reference", reference(), output("both") + "/1", "--json"});
    EXPECT_EQ(alone.exit_code, 3);
    EXPECT_NE(alone.errors.find("only 0 of the model's 1 images"), std::string::npos);
}

}  // namespace
}  // namespace psfm
