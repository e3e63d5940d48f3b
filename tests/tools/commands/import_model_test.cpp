// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// `psfm import --colmap-model`: what goes in comes out.
#include <gtest/gtest.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "storage/exchange/models/read_colmap.h"
#include "storage/exchange/models/write_models.h"
#include "storage/session/session_store.h"
#include "tests/storage/exchange/example_model.h"
#include "tests/tools/commands/dataset_session.h"
#include "tools/commands/commands.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

struct Outcome {
    int exit_code = 0;
    std::string output;
    std::string errors;
};

Outcome run(std::vector<std::string> arguments) {
    CLI::App app{"psfm"};
    app.require_subcommand(1);
    Outcome outcome;
    add_export_command(app, outcome.exit_code);
    add_import_command(app, outcome.exit_code);
    std::ranges::reverse(arguments);
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

/// A COLMAP model of the nine photographs of DatasetSession's first part, with ids that have gaps.
class ImportModel : public testing::Test {
  protected:
    ImportModel() {
        const Outcome exported = run({"export", "--session", session_.session(), "--format",
                                      "colmap", "--output", place("made")});
        EXPECT_EQ(exported.exit_code, 0) << exported.errors;
        auto model = read_colmap_model(place("made/0"));
        EXPECT_TRUE(model);
        const std::vector<std::uint32_t> image_ids{2, 3, 5, 8, 13, 21, 34, 55, 89};
        const std::vector<std::uint32_t> camera_ids{4, 6, 9};
        model_ = renumbered(*std::move(model), image_ids, camera_ids);
        EXPECT_TRUE(write_models(std::vector{model_}, ExportFormat::kColmap, place("given")));
        // The other part's photographs would be new.
        fs::remove_all(session_.photo_folder() / "far");
    }

    std::string place(const std::string& name) const { return (folder_.path() / name).string(); }
    std::string photos() const { return session_.photo_folder().string(); }

    /// Takes the model of a folder over, and gives it out again.
    Result<ExportedModel> taken_and_given(const std::string& model, Outcome& imported) const {
        imported = run({"import", "--session", place("taken"), "--colmap-model", place(model),
                        "--images", photos()});
        EXPECT_EQ(imported.exit_code, 0) << imported.errors;
        EXPECT_EQ(run({"export", "--session", place("taken"), "--format", "colmap", "--output",
                       place("again")})
                      .exit_code,
                  0);
        return read_colmap_model(place("again/0"));
    }

    /// Imports a changed model.
    Outcome imported(const ExportedModel& model) const {
        EXPECT_TRUE(write_models(std::vector{model}, ExportFormat::kColmap, place("changed")));
        return run({"import", "--session", place("taken"), "--colmap-model", place("changed/0"),
                    "--images", photos()});
    }

    test::TemporaryFolder folder_;
    test::DatasetSession session_{folder_.path()};
    ExportedModel model_;
};

TEST_F(ImportModel, UnchangedItIsTheSameModel) {
    // As of undistorted images, places have more digits than float.
    for (ExportedImage& image : model_.images) {
        for (ExportedKeypoint& keypoint : image.keypoints) keypoint.x += 1e-6 / 3.0;
    }
    ASSERT_TRUE(write_models(std::vector{model_}, ExportFormat::kColmap, place("given")));
    Outcome imported;
    const auto again = taken_and_given("given/0", imported);
    ASSERT_TRUE(again);
    EXPECT_NE(imported.output.find("taken over: 9 images, 9 points"), std::string::npos)
        << imported.output;
    for (const auto& entry : fs::directory_iterator(folder_.path()))
        EXPECT_FALSE(entry.path().filename().string().starts_with("taken.importing"));
    ASSERT_EQ(again->images.size(), model_.images.size());
    ASSERT_EQ(again->cameras.size(), model_.cameras.size());
    ASSERT_EQ(again->points.size(), model_.points.size());
    for (std::size_t i = 0; i < model_.images.size(); ++i) {
        const ExportedImage& before = model_.images[i];
        const ExportedImage& after = again->images[i];
        EXPECT_EQ(after.id, before.id);
        EXPECT_EQ(after.name, before.name);
        EXPECT_EQ(after.camera_id, before.camera_id);
        EXPECT_LT(angle_between(after.cam_from_world.rotation, before.cam_from_world.rotation),
                  1e-9);
        EXPECT_LT((after.cam_from_world.translation - before.cam_from_world.translation).norm(),
                  1e-9);
        // The model's features come first, in their order.
        ASSERT_GE(after.keypoints.size(), before.keypoints.size());
        for (std::size_t k = 0; k < before.keypoints.size(); ++k) {
            EXPECT_NEAR(after.keypoints[k].x, before.keypoints[k].x, 1e-9);
            EXPECT_NEAR(after.keypoints[k].y, before.keypoints[k].y, 1e-9);
        }
    }
    for (std::size_t c = 0; c < model_.cameras.size(); ++c) {
        EXPECT_EQ(again->cameras[c].id, model_.cameras[c].id);
        EXPECT_EQ(again->cameras[c].camera.params, model_.cameras[c].camera.params);
    }
    for (std::size_t p = 0; p < model_.points.size(); ++p) {
        EXPECT_LT((again->points[p].position - model_.points[p].position).norm(), 1e-9);
        EXPECT_EQ(again->points[p].track, model_.points[p].track);
    }
    // The same command again has nothing to do.
    const Outcome again_imported = run({"import", "--session", place("taken"), "--colmap-model",
                                        place("given/0"), "--images", photos()});
    EXPECT_EQ(again_imported.exit_code, 0) << again_imported.errors;
    EXPECT_NE(again_imported.output.find("no photograph"), std::string::npos);
    // Of another model the session does not go on, nor of none.
    ExportedModel other = model_;
    other.images.back().id += 1;
    for (ExportedPoint& point : other.points) {
        for (ExportedObservation& seen : point.track)
            seen.image_id += seen.image_id == model_.images.back().id ? 1 : 0;
    }
    EXPECT_NE(this->imported(other).errors.find("which has other images"), std::string::npos);
    fs::remove(place("given/0/images.bin"));
    EXPECT_EQ(run({"import", "--session", place("taken"), "--colmap-model", place("given/0"),
                   "--images", photos()})
                  .exit_code,
              3);
}

TEST_F(ImportModel, LaterImagesGetIdsThatColmapKnows) {
    const std::vector<std::uint32_t> given{1, 2, 4, 2147483645};
    ExportedModel later;
    for (std::uint32_t id = 1; id <= 8; ++id) {
        ExportedImage image;
        image.id = id;
        image.camera_id = 1;
        later.images.push_back(image);
    }
    later.cameras.emplace_back().id = 1;
    const ExportedModel numbered = renumbered(later, given, std::vector<std::uint32_t>{4294967295});
    std::vector<std::uint32_t> ids;
    for (const ExportedImage& image : numbered.images) ids.push_back(image.id);
    EXPECT_EQ(ids, (std::vector<std::uint32_t>{1, 2, 3, 4, 5, 6, 2147483645, 2147483646}));
}

TEST_F(ImportModel, ItsPhotographsAreFoundAfterARunElsewhere) {
    ASSERT_EQ(run({"import", "--session", place("taken"), "--colmap-model", place("given/0"),
                   "--images", photos()})
                  .exit_code,
              0);
    {
        const auto store = SessionStore::open_existing(place("taken"), StoreOptions{});
        ASSERT_TRUE(store);
        auto settings = (*store)->settings();
        ASSERT_TRUE(settings);
        settings->photo_folder = place("elsewhere");
        ASSERT_TRUE((*store)->put_settings(*settings));
    }
    const Outcome done = run(
        {"export", "--session", place("taken"), "--format", "dataset", "--output", place("data")});
    EXPECT_EQ(done.errors, "");
    EXPECT_NE(done.output.find("9 pictures written"), std::string::npos) << done.output;
}

TEST_F(ImportModel, PointsOfOneImageAreTold) {
    ExportedPoint& point = model_.points[4];
    for (std::size_t k = 1; k < point.track.size(); ++k) {
        const auto image = std::ranges::lower_bound(model_.images, point.track[k].image_id, {},
                                                    &ExportedImage::id);
        image->keypoints[point.track[k].keypoint].point = kNoPoint;
    }
    point.track.resize(1);
    const Outcome done = imported(model_);
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    EXPECT_NE(done.errors.find("1 point of the model left out"), std::string::npos) << done.errors;
}

TEST_F(ImportModel, PointsSeenTwiceAndTheirColoursComeOutAgain) {
    std::vector<ExportedModel> given{model_};
    ExportedPoint& point = given[0].points[4];
    point.rgb = {200, 10, 77};
    const std::uint32_t id = point.track[0].image_id;
    auto& keypoints =
        std::ranges::lower_bound(given[0].images, id, {}, &ExportedImage::id)->keypoints;
    const auto free = std::ranges::find(keypoints, kNoPoint, &ExportedKeypoint::point);
    if (free == keypoints.end()) {
        for (ExportedImage& image : given[0].images)
            image.keypoints.push_back({7.0, 8.0, kNoPoint});
    }
    const auto beside = static_cast<std::uint32_t>(
        std::ranges::find(keypoints, kNoPoint, &ExportedKeypoint::point) - keypoints.begin());
    keypoints[beside].point = point.id;
    point.track.push_back({id, beside});
    std::ranges::sort(point.track);
    ASSERT_TRUE(write_models(given, ExportFormat::kColmap, place("twice")));
    Outcome imported;
    const auto again = taken_and_given("twice/0", imported);
    ASSERT_TRUE(again);
    ASSERT_EQ(again->points.size(), given[0].points.size());
    for (std::size_t p = 0; p < again->points.size(); ++p) {
        EXPECT_EQ(again->points[p].track, given[0].points[p].track);
        EXPECT_EQ(again->points[p].rgb, given[0].points[p].rgb);
    }
}

TEST_F(ImportModel, WhatCannotBeTakenOverLeavesNoSession) {
    const std::string images = test::file_bytes(fs::path(place("given/0")) / "images.bin");
    test::put_file(fs::path(place("cut")) / "images.bin", images.substr(0, images.size() / 2));
    fs::copy_file(fs::path(place("given/0")) / "cameras.bin",
                  fs::path(place("cut")) / "cameras.bin");
    fs::copy_file(fs::path(place("given/0")) / "points3D.bin",
                  fs::path(place("cut")) / "points3D.bin");
    const std::vector<std::vector<std::string>> bad{
        {"--colmap-model", place("cut"), "--images", photos()},
        {"--colmap-model", place("none"), "--images", photos()},
        {"--colmap-model", place("given/0"), "--images", place("given")},
        {"--colmap-model", place("given/0"), "--images", photos(), "--colmap-database",
         place("given/0/images.bin")}};
    for (const auto& options : bad) {
        std::vector<std::string> arguments{"import", "--session", place("never")};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const Outcome refused = run(arguments);
        EXPECT_EQ(refused.exit_code, 3) << options[1] << refused.errors;
        EXPECT_NE(refused.errors.find(folder_.path().string()), std::string::npos)
            << refused.errors;
        EXPECT_FALSE(fs::exists(place("never"))) << options[1];
        EXPECT_FALSE(fs::exists(place("never.importing")));
    }
    EXPECT_EQ(
        run({"import", "--session", place("never"), "--colmap-model", place("given/0")}).exit_code,
        2);
    EXPECT_EQ(run({"import", "--session", place("never")}).exit_code, 2);
}

TEST_F(ImportModel, ANameThatIsTooLongIsAPhotographLess) {
    const std::string before = model_.images[0].name;
    model_.images[0].name = std::string(300, 'a') + ".jpg";
    fs::remove(session_.photo_folder() / before);
    const Outcome done = imported(model_);
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    EXPECT_NE(done.errors.find("lacks " + model_.images[0].name + " (File name too long)"),
              std::string::npos)
        << done.errors;
}

TEST_F(ImportModel, AnUnreadablePhotographIsTold) {
    test::put_file(session_.photo_folder() / model_.images[0].name, "no picture");
    const Outcome done = imported(model_);
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    EXPECT_NE(done.output.find("taken over: 9 images"), std::string::npos) << done.output;
    EXPECT_NE(done.errors.find("psfm: " + model_.images[0].name + ": "), std::string::npos)
        << done.errors;
    EXPECT_NE(done.errors.find("without what photographs add"), std::string::npos);
}

TEST_F(ImportModel, ACameraOfAnotherSizeNamesTheModelToo) {
    model_.cameras[0].camera.width *= 2;
    const Outcome done = imported(model_);
    EXPECT_EQ(done.exit_code, 3) << done.errors;
    EXPECT_NE(done.errors.find(place("changed/0") + ", camera 4: "), std::string::npos)
        << done.errors;
    EXPECT_FALSE(fs::exists(place("taken")));
}

TEST_F(ImportModel, PointsThatAreNotWhereTheirFeaturesAreAreRefused) {
    for (ExportedCamera& camera : model_.cameras) camera.camera.params[1] += 1000.0;
    const Outcome done = imported(model_);
    EXPECT_EQ(done.exit_code, 3) << done.errors;
    EXPECT_NE(done.errors.find("points do not lie where their images' features are"),
              std::string::npos)
        << done.errors;
    EXPECT_FALSE(fs::exists(place("taken")));
}

TEST_F(ImportModel, PointsBehindTheirCamerasAreRefused) {
    const Eigen::Quaterniond turn(0.0, 0.0, 1.0, 0.0);  // half a turn about y
    for (ExportedImage& image : model_.images) {
        image.cam_from_world.rotation = turn * image.cam_from_world.rotation;
        image.cam_from_world.translation = turn * image.cam_from_world.translation;
    }
    const Outcome done = imported(model_);
    EXPECT_EQ(done.exit_code, 3) << done.errors;
    EXPECT_NE(done.errors.find("points lie behind their cameras"), std::string::npos)
        << done.errors;
    EXPECT_FALSE(fs::exists(place("taken")));
}

}  // namespace
}  // namespace psfm
