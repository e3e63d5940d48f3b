// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdlib>

#include "storage/exchange/models/read_colmap.h"
#include "storage/exchange/models/write_models.h"
#include "tests/storage/exchange/example_model.h"
#include "tests/storage/exchange/models_equal.h"

namespace psfm {
namespace {

class ColmapRoundTrip : public testing::TestWithParam<ExportFormat> {};

TEST_P(ColmapRoundTrip, ReadsBackBitByBit) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const test::TemporaryFolder folder;
        const std::vector<ExportedModel> models{test::example_model(6, 40, seed)};
        const auto written = write_models(models, GetParam(), folder.path());
        ASSERT_TRUE(written.ok()) << written.error().message;
        EXPECT_EQ(written->front(), folder.path() / "0");
        const auto read = read_colmap_model(written->front());
        ASSERT_TRUE(read.ok()) << read.error().message;
        test::expect_equal(*read, models[0]);
    }
}

TEST_P(ColmapRoundTrip, EmptyPartsAreFine) {
    const test::TemporaryFolder folder;
    std::vector<ExportedModel> models{test::example_model(3, 0, 1)};
    ASSERT_TRUE(write_models(models, GetParam(), folder.path()).ok());
    const auto read = read_colmap_model(folder.path() / "0");
    ASSERT_TRUE(read.ok()) << read.error().message;
    test::expect_equal(*read, models[0]);
}

INSTANTIATE_TEST_SUITE_P(Encodings, ColmapRoundTrip,
                         testing::Values(ExportFormat::kColmap, ExportFormat::kColmapText));

TEST(WriteColmap, NamesWithSpaces) {
    const test::TemporaryFolder folder;
    std::vector<ExportedModel> models{test::example_model(3, 10, 1)};
    models[0].images[1].name = "holiday pictures/IMG 1.jpg";
    const auto refused = write_models(models, ExportFormat::kColmapText, folder.path());
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(test::count_files(folder.path()), 0U);
    ASSERT_TRUE(write_models(models, ExportFormat::kColmap, folder.path()).ok());
    test::expect_equal(*read_colmap_model(folder.path() / "0"), models[0]);
}

/// COLMAP itself, where it is installed.
class ColmapProgram : public testing::Test {
  protected:
    void SetUp() override {
        if (std::system("command -v colmap >/dev/null 2>&1") != 0) {
            GTEST_SKIP() << "colmap is not installed";
        }
    }
    /// @return what it printed
    std::string run(const std::string& arguments) {
        const std::filesystem::path log = folder_.path() / "log";
        const std::string command =
            "QT_QPA_PLATFORM=offscreen colmap " + arguments + " >" + log.string() + " 2>&1";
        EXPECT_EQ(std::system(command.c_str()), 0) << test::file_bytes(log);
        return test::file_bytes(log);
    }

    test::TemporaryFolder folder_;
};

TEST_F(ColmapProgram, AcceptsBothEncodingsAndReadsTheSame) {
    const std::vector<ExportedModel> models{test::example_model(6, 60, 9)};
    const std::string here = folder_.path().string();
    ASSERT_TRUE(write_models(models, ExportFormat::kColmap, folder_.path() / "bin").ok());
    ASSERT_TRUE(write_models(models, ExportFormat::kColmapText, folder_.path() / "txt").ok());
    for (const std::string encoding : {"bin", "txt"}) {
        const std::string report = run("model_analyzer --path " + here + "/" + encoding + "/0");
        EXPECT_NE(report.find("Registered images: 6"), std::string::npos) << report;
        EXPECT_NE(report.find("Points: " + std::to_string(models[0].points.size())),
                  std::string::npos)
            << report;
        for (const std::string target : {"BIN", "TXT"}) {
            const std::string output = encoding + "-to-" + target;
            std::filesystem::create_directory(folder_.path() / output);
            run("model_converter --input_path " + here + "/" + encoding + "/0 --output_path " +
                here + "/" + output + " --output_type " + target);
            const auto read = read_colmap_model(folder_.path() / output);
            ASSERT_TRUE(read.ok()) << read.error().message;
            ASSERT_EQ(read->images.size(), 6U);
            EXPECT_EQ(read->cameras, models[0].cameras);
            for (std::size_t i = 0; i < 6; ++i) {
                const ExportedImage& image = models[0].images[i];
                EXPECT_EQ(read->images[i].name, image.name);
                EXPECT_EQ(read->images[i].keypoints, image.keypoints);
                // COLMAP normalises quaternions: the last digit may differ.
                EXPECT_TRUE(read->images[i].cam_from_world.rotation.coeffs().isApprox(
                    image.cam_from_world.rotation.coeffs(), 1e-15));
                EXPECT_EQ(read->images[i].cam_from_world.translation,
                          image.cam_from_world.translation);
            }
            ASSERT_EQ(read->points.size(), models[0].points.size());
            for (std::size_t i = 0; i < read->points.size(); ++i) {
                EXPECT_EQ(read->points[i].position, models[0].points[i].position);
                EXPECT_EQ(read->points[i].rgb, models[0].points[i].rgb);
                EXPECT_EQ(read->points[i].track, models[0].points[i].track);
            }
        }
    }
}

}  // namespace
}  // namespace psfm
