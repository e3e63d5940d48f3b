// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// `psfm export --format dataset` on a session whose pictures, points and poses are known.
#include <gtest/gtest.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <csignal>
#include <cstdlib>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "storage/exchange/models/read_colmap.h"
#include "tests/storage/exchange/example_model.h"
#include "tests/tools/commands/dataset_session.h"
#include "tests/tools/commands/trainer_rules.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/interrupts.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

struct Outcome {
    int exit_code = 0;
    std::string output;
    std::string errors;
};

std::vector<std::string> lines_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

class ExportDataset : public testing::Test {
  protected:
    Outcome export_to(const std::string& name, std::vector<std::string> options = {}) {
        CLI::App app{"psfm"};
        app.require_subcommand(1);
        Outcome outcome;
        add_export_command(app, outcome.exit_code);
        std::vector<std::string> arguments{"export",  "--session", session_.session(),  "--format",
                                           "dataset", "--output",  place(name).string()};
        arguments.insert(arguments.end(), options.begin(), options.end());
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

    fs::path place(const std::string& name) const { return folder_.path() / name; }

    ExportedModel model_in(const std::string& dataset) const {
        auto model = read_colmap_model(place(dataset) / "sparse" / "0");
        EXPECT_TRUE(model) << (model ? "" : model.error().message);
        return model ? *std::move(model) : ExportedModel{};
    }

    /// Every file with when it was written and its place on the disk.
    std::map<std::string, std::pair<fs::file_time_type, std::size_t>> state_of(
        const std::string& name) const {
        std::map<std::string, std::pair<fs::file_time_type, std::size_t>> state;
        for (const auto& entry : fs::recursive_directory_iterator(place(name))) {
            if (entry.is_regular_file())
                state[entry.path().string()] = {entry.last_write_time(), entry.file_size()};
        }
        return state;
    }

    /// Blobs are where the picture's camera sees their points, and so are the features.
    void expect_true_pictures(const std::string& dataset, double max_px = 0.001) const {
        const ExportedModel model = model_in(dataset);
        std::size_t looked_at = 0;
        for (const ExportedImage& image : model.images) {
            const Camera& camera = model.find_camera(image.camera_id)->camera;
            const cv::Mat picture =
                cv::imread((place(dataset) / "images" / image.name).string(), cv::IMREAD_COLOR);
            ASSERT_EQ(picture.cols, static_cast<int>(camera.width));
            ASSERT_EQ(picture.rows, static_cast<int>(camera.height));
            for (const ExportedKeypoint& keypoint : image.keypoints) {
                ASSERT_NE(keypoint.point, kNoPoint);
                const ExportedPoint* point = model.find_point(keypoint.point);
                ASSERT_NE(point, nullptr);
                const auto seen = project(camera, image.cam_from_world * point->position);
                ASSERT_TRUE(seen);
                EXPECT_LT((*seen - Eigen::Vector2d(keypoint.x, keypoint.y)).norm(), max_px);
                const bool inside = seen->minCoeff() > 16 && seen->x() < camera.width - 16 &&
                                    seen->y() < camera.height - 16;
                if (!inside) continue;
                ++looked_at;
                EXPECT_LT((test::blob_near(picture, *seen) - *seen).norm(), 0.3) << image.name;
            }
            for (const ExportedPoint& point : model.points) EXPECT_GE(point.track.size(), 2U);
        }
        EXPECT_GT(looked_at, 4 * model.images.size());
    }

    test::TemporaryFolder folder_;
    test::DatasetSession session_{folder_.path()};
};

TEST_F(ExportDataset, PicturesAreUndistortedUprightAndTrue) {
    const Outcome outcome = export_to("data");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_EQ(outcome.errors, "");
    EXPECT_NE(outcome.output.find("data/0: 9 images of"), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find("data/1: 2 images of 1 camera, 9 points"), std::string::npos);
    expect_true_pictures("data/0");
    expect_true_pictures("data/1");
    // Turned by its orientation, what was the photograph's up side is the picture's: 6 means that
    // the first column is at the top.
    const ExportedModel model = model_in("data/0");
    const ExportedImage* six = model.find_image(7);
    ASSERT_NE(six, nullptr);
    EXPECT_EQ(six->name, "six.jpg");
    const Eigen::Vector3d up =
        session_.photos()[6].cam_from_world.rotation.conjugate() * -Eigen::Vector3d::UnitX();
    EXPECT_LT((six->cam_from_world.rotation * up + Eigen::Vector3d::UnitY()).norm(), 1e-9);
    const Camera& camera = model.find_camera(six->camera_id)->camera;
    EXPECT_LT(camera.height, 301U);  // 300 x 320 lay on its side
}

TEST_F(ExportDataset, NamesAreUniqueWhereverTheyAreRead) {
    ASSERT_EQ(export_to("data").exit_code, 0);
    std::vector<std::string> names;
    for (const ExportedImage& image : model_in("data/0").images) names.push_back(image.name);
    const std::vector<std::string> expected{
        "a_photo.jpg", "b_photo.jpg", "b_Photo_2.jpg", "with_blank_and_dots.jpg",
        "drawn.png",   "five.jpg",    "six.jpg",       "seven.jpg",
        "eight.jpg"};
    EXPECT_EQ(names, expected);
}

TEST_F(ExportDataset, DamagedSettingsCostMasksOnly) {
    session_.damage_settings();
    const auto outcome = export_to("data");
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_NE(outcome.errors.find("settings are damaged"), std::string::npos) << outcome.errors;
    EXPECT_NE(outcome.errors.find("--mask-folder"), std::string::npos) << outcome.errors;
}

TEST_F(ExportDataset, EveryReaderOpensIt) {
    ASSERT_EQ(export_to("data", {"--reduced", "2", "4", "8"}).exit_code, 0);
    for (const char* part : {"data/0", "data/1"}) {
        test::expect_3dgs_opens(place(part));
        for (const int factor : {1, 2, 4, 8}) test::expect_gsplat_opens(place(part), factor);
        test::expect_nerfstudio_opens(place(part), {1, 2, 4, 8});
        test::expect_opensplat_opens(place(part));
        test::expect_brush_opens(place(part));
        test::expect_lichtfeld_opens(place(part));
        test::expect_openmvs_opens(place(part));
        test::expect_colmap_stereo_opens(place(part));
    }
}

// Masks lie on the photographs' stored grid, or upright; here one hides what is left of the middle
// of a photograph that has to be turned, and one a quarter of one that lies in a sub-folder.
TEST_F(ExportDataset, MasksGoWherePicturesGo) {
    fs::create_directories(place("masks/a"));
    const test::BlobPhoto& six = session_.photos()[6];
    const Camera camera = session_.cameras().at(six.camera);
    cv::Mat half(static_cast<int>(camera.height), static_cast<int>(camera.width), CV_8UC1,
                 cv::Scalar(255));
    half.colRange(0, half.cols / 2).setTo(0);
    cv::imwrite(place("masks/six_mask.png").string(), half);
    cv::Mat quarter(300, 400, CV_8UC1, cv::Scalar(255));
    quarter(cv::Rect(0, 0, 200, 150)).setTo(0);
    cv::imwrite(place("masks/a/photo.jpg.png").string(), quarter);
    const std::vector<std::string> options{"--mask-folder", place("masks").string(), "--reduced",
                                           "2"};
    const auto masked = export_to("data", options);
    ASSERT_EQ(masked.exit_code, 0);
    EXPECT_EQ(masked.errors.find("PHOTOGRAPH"), std::string::npos) << masked.errors;
    const auto mask_of = [&](const std::string& name) {
        return cv::imread((place("data/0/masks") / name).string(), cv::IMREAD_GRAYSCALE);
    };
    const auto visible = [](const cv::Mat& mask) {
        return cv::countNonZero(mask) / static_cast<double>(mask.total());
    };
    // Its left side is up now: 6 means that the first column is at the top.
    const cv::Mat turned = mask_of("six.png");
    ASSERT_FALSE(turned.empty());
    EXPECT_EQ(cv::countNonZero(turned.rowRange(0, turned.rows / 2 - 4)), 0);
    const cv::Mat lower = turned.rowRange(turned.rows / 2 + 4, turned.rows);
    EXPECT_EQ(cv::countNonZero(lower), static_cast<int>(lower.total()));
    EXPECT_NEAR(visible(mask_of("a_photo.png")), 0.75, 0.03);
    EXPECT_EQ(visible(mask_of("seven.png")), 1.0);
    test::expect_nerfstudio_opens(place("data/0"), {1, 2});
    test::expect_brush_opens(place("data/0"));
    // Nothing is written twice; a mask that is another one makes its picture's anew, and only that.
    const auto before = state_of("data");
    ASSERT_EQ(export_to("data", options).exit_code, 0);
    EXPECT_EQ(state_of("data"), before);
    cv::imwrite(place("masks/seven.png").string(), quarter);
    EXPECT_NE(export_to("data", options).output.find("1 picture written"), std::string::npos);
    EXPECT_NEAR(visible(mask_of("seven.png")), 0.75, 0.03);
    // A folder whose masks fit nothing is told of.
    fs::create_directories(place("others"));
    cv::imwrite(place("others/stranger.png").string(), quarter);
    const auto others = export_to("data", {"--mask-folder", place("others").string()});
    EXPECT_NE(others.errors.find("MASKS WITHOUT A PHOTOGRAPH"), std::string::npos) << others.errors;
    EXPECT_NE(others.errors.find("no photograph has a mask"), std::string::npos) << others.errors;
    // That of the photographs has none either.
    const auto own = export_to("data", {"--mask-folder", session_.photo_folder().string()});
    EXPECT_NE(own.errors.find("no photograph has a mask"), std::string::npos) << own.errors;
    // Without them they go.
    ASSERT_EQ(export_to("data").exit_code, 0);
    EXPECT_FALSE(fs::exists(place("data/0/masks/six.png")));
    EXPECT_EQ(test::file_bytes(place("data/0/transforms.json")).find("mask_path"),
              std::string::npos);
}

TEST_F(ExportDataset, ColmapItselfReadsIt) {
    if (std::system("colmap help >/dev/null 2>&1") != 0) GTEST_SKIP() << "no colmap here";
    ASSERT_EQ(export_to("data").exit_code, 0);
    for (const char* folder : {"sparse", "sparse/0"}) {
        const std::string command = "colmap model_analyzer --path '" +
                                    (place("data/0") / folder).string() + "' >'" +
                                    place("report").string() + "' 2>&1";
        ASSERT_EQ(std::system(command.c_str()), 0) << test::file_bytes(place("report"));
        const std::string report = test::file_bytes(place("report"));
        EXPECT_NE(report.find("Registered images: 9"), std::string::npos) << report;
        EXPECT_NE(report.find("Points: 9"), std::string::npos) << report;
    }
}

TEST_F(ExportDataset, ASecondRunWritesNothing) {
    ASSERT_EQ(export_to("data", {"--reduced", "2"}).exit_code, 0);
    const auto before = state_of("data");
    const Outcome again = export_to("data", {"--reduced", "2"});
    ASSERT_EQ(again.exit_code, 0) << again.errors;
    EXPECT_EQ(state_of("data"), before);
    EXPECT_NE(again.output.find("0 pictures written"), std::string::npos) << again.output;
}

TEST_F(ExportDataset, OnlyWhatHasChangedIsWrittenAgain) {
    ASSERT_EQ(export_to("data").exit_code, 0);
    auto cameras = session_.cameras();
    cameras[CameraId{0}].params[0] *= 1 + 1e-6;  // a thousandth of a pixel at the corner
    cameras[CameraId{1}].params[3] += 0.002;
    session_.publish(2, cameras);
    const Outcome outcome = export_to("data");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_NE(outcome.output.find("3 pictures written"), std::string::npos) << outcome.output;
    expect_true_pictures("data/0", 0.2);  // the truth is that of the first cameras
    // One that is gone comes back, alone.
    fs::remove(place("data/0/images/drawn.png"));
    EXPECT_NE(export_to("data").output.find("1 picture written"), std::string::npos);
    EXPECT_TRUE(fs::exists(place("data/0/images/drawn.png")));
    // Other options are other pictures.
    const Outcome small = export_to("data", {"--max-size", "200"});
    EXPECT_NE(small.output.find("9 pictures written"), std::string::npos) << small.output;
    for (const ExportedCamera& camera : model_in("data/0").cameras)
        EXPECT_LE(std::max(camera.camera.width, camera.camera.height), 200U);
}

TEST_F(ExportDataset, OnePartGoesIntoTheFolderItself) {
    ASSERT_EQ(export_to("one", {"--part", "1"}).exit_code, 0);
    EXPECT_EQ(model_in("one").images.size(), 2U);
    test::expect_3dgs_opens(place("one"));
    EXPECT_FALSE(fs::exists(place("one/0")));
    const Outcome none = export_to("none", {"--part", "2"});
    EXPECT_EQ(none.exit_code, 3);
    EXPECT_NE(none.errors.find("there is no part 2"), std::string::npos) << none.errors;
    EXPECT_FALSE(fs::exists(place("none")));
}

TEST_F(ExportDataset, PhotographsThatCannotBeUsedAreToldOfAndLeftOut) {
    fs::remove(session_.photo_folder() / "a/photo.jpg");
    fs::copy_file(session_.photo_folder() / "five.jpg", session_.photo_folder() / "seven.jpg",
                  fs::copy_options::overwrite_existing);
    const Outcome outcome = export_to("data");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_NE(outcome.errors.find("left out a/photo.jpg: "), std::string::npos) << outcome.errors;
    EXPECT_NE(outcome.errors.find("left out seven.jpg: "), std::string::npos);
    EXPECT_EQ(model_in("data/0").images.size(), 7U);
    test::expect_3dgs_opens(place("data/0"));
    test::expect_gsplat_opens(place("data/0"), 1);
    // With their folder gone there is nothing to write; where another has them, all is well.
    fs::rename(session_.photo_folder(), place("moved"));
    const Outcome gone = export_to("elsewhere");
    EXPECT_EQ(gone.exit_code, 3);
    EXPECT_NE(gone.errors.find("--images"), std::string::npos) << gone.errors;
    EXPECT_FALSE(fs::exists(place("elsewhere")));
    EXPECT_EQ(export_to("elsewhere", {"--images", place("moved").string()}).exit_code, 0);
}

TEST_F(ExportDataset, WhatIsNotOursIsLeftAlone) {
    test::put_file(place("data/0/images/five.jpg"), "mine");
    const Outcome refused = export_to("data");
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_NE(refused.errors.find("data/0/images/five.jpg was not written by psfm"),
              std::string::npos)
        << refused.errors;
    EXPECT_EQ(test::count_files(place("data")), 1U);
    fs::remove(place("data/0/images/five.jpg"));
    ASSERT_EQ(export_to("data").exit_code, 0);
    test::put_file(place("data/0/output/splats.ply"), "trained");
    auto cameras = session_.cameras();
    cameras[CameraId{0}].params[3] += 0.01;
    session_.publish(2, cameras);
    ASSERT_EQ(export_to("data").exit_code, 0);
    EXPECT_EQ(test::file_bytes(place("data/0/output/splats.ply")), "trained");
}

TEST_F(ExportDataset, OfAPartThatIsNoMoreNothingIsLeft) {
    ASSERT_EQ(export_to("data").exit_code, 0);
    // As if the session had had two more parts then.
    std::string list = test::file_bytes(place("data/.psfm-export"));
    for (const std::string& line : lines_of(list)) {
        for (const char* part : {"7", "8"}) {
            if (line.starts_with("0/")) list += part + line.substr(1) + "\n";
        }
    }
    test::put_file(place("data/.psfm-export"), list);
    for (const char* part : {"data/7", "data/8"})
        fs::copy(place("data/0"), place(part), fs::copy_options::recursive);
    test::put_file(place("data/8/stereo/depth_maps/five.bin"), "by COLMAP");
    ASSERT_EQ(export_to("data").exit_code, 0);
    EXPECT_FALSE(fs::exists(place("data/7")));
    EXPECT_EQ(test::count_files(place("data/8")), 1U);
    EXPECT_FALSE(fs::exists(place("data/8/stereo/normal_maps")));
    EXPECT_TRUE(fs::exists(place("data/0/stereo/depth_maps")));
}

TEST_F(ExportDataset, LeftoversOfAKilledExportGo) {
    ASSERT_EQ(export_to("data").exit_code, 0);
    test::put_file(place("data/.psfm-partial/0/images/five.jpg"), "half");
    ASSERT_EQ(export_to("data").exit_code, 0);
    EXPECT_FALSE(fs::exists(place("data/.psfm-partial")));
}

TEST_F(ExportDataset, StoppedItLeavesNothing) {
    const auto stopped = [&] {
        catch_interrupts();
        std::raise(SIGINT);
        std::exit(export_to("data").exit_code);
    };
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    EXPECT_EXIT(stopped(), testing::ExitedWithCode(1), "");
    EXPECT_FALSE(fs::exists(place("data")));
}

TEST_F(ExportDataset, PhotographsInSeveralFoldersAreFound) {
    fs::create_directories(place("card"));
    fs::rename(session_.photo_folder() / "five.jpg", place("card/five.jpg"));
    const std::string photos = session_.photo_folder().string();
    ASSERT_EQ(export_to("one", {"--images", photos}).exit_code, 0);
    EXPECT_FALSE(fs::exists(place("one/0/images/five.jpg")));
    ASSERT_EQ(export_to("two", {"--images", photos, "--images", place("card").string()}).exit_code,
              0);
    EXPECT_TRUE(fs::exists(place("two/0/images/five.jpg")));
}

TEST_F(ExportDataset, PartsOfAPictureAreNumbers) {
    for (const char* part : {"nan", "-0.1", "1.5", "much"})
        EXPECT_EQ(export_to("data", {"--blank-pixels", part}).exit_code, 2) << part;
    EXPECT_EQ(export_to("data", {"--blank-pixels", "0.5"}).exit_code, 0);
}

TEST_F(ExportDataset, OptionsOfADataSetGoWithNothingElse) {
    CLI::App app{"psfm"};
    int exit_code = 0;
    add_export_command(app, exit_code);
    std::vector<std::string> arguments{"4",     "--reduced", place("x").string(), "--output",
                                       "ply",   "--format",  session_.session(),  "--session",
                                       "export"};
    testing::internal::CaptureStderr();
    app.parse(arguments);
    const std::string errors = testing::internal::GetCapturedStderr();
    EXPECT_EQ(exit_code, 2);
    EXPECT_NE(errors.find("--reduced goes with --format dataset only"), std::string::npos)
        << errors;
}

}  // namespace
}  // namespace psfm
