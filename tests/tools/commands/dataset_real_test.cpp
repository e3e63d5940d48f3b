// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Data sets of ordinary photographs: as true as the model that they were made of.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "storage/exchange/models/read_colmap.h"
#include "tests/storage/exchange/example_model.h"
#include "tests/tools/commands/dataset_truth.h"
#include "tests/tools/commands/psfm_commands.h"
#include "tests/tools/commands/trainer_rules.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

class DatasetReal : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        const char* datasets = std::getenv("PSFM_DATASETS");
        if (datasets == nullptr) GTEST_SKIP() << "PSFM_DATASETS is not set";
        photos_ = fs::path(datasets) / GetParam() / "images";
        if (!fs::is_directory(photos_)) GTEST_SKIP() << photos_ << " is not there";
    }

    std::string place(const std::string& name) const { return (folder_.path() / name).string(); }

    std::map<std::string, fs::file_time_type> times_in(const std::string& name) const {
        std::map<std::string, fs::file_time_type> times;
        for (const auto& entry : fs::recursive_directory_iterator(place(name))) {
            if (entry.is_regular_file()) times[entry.path().string()] = entry.last_write_time();
        }
        return times;
    }

    test::TemporaryFolder folder_;
    fs::path photos_;
};

TEST_P(DatasetReal, IsAsTrueAsItsModel) {
    ASSERT_EQ(test::psfm_command(
                  {"run", photos_.string(), "--session", place("session"), "--threads", "2"}),
              0);
    ASSERT_EQ(test::psfm_command({"export", "--session", place("session"), "--format", "colmap",
                                  "--output", place("model")}),
              0);
    const std::vector<std::string> dataset{"export",  "--session", place("session"), "--format",
                                           "dataset", "--output",  place("data"),    "--reduced",
                                           "2",       "4"};
    ASSERT_EQ(test::psfm_command(dataset), 0);
    const fs::path part = fs::path(place("data")) / "0";
    const auto before = read_colmap_model(fs::path(place("model")) / "0");
    const auto after = read_colmap_model(part / "sparse" / "0");
    ASSERT_TRUE(before && after);
    EXPECT_EQ(after->images.size(), before->images.size());
    EXPECT_GT(10 * after->points.size(), 9 * before->points.size());  // less those upon another
    EXPECT_NEAR(test::median_residual_px(*after), test::median_residual_px(*before), 0.01);
    const auto borders = test::look_at_borders(part);
    ASSERT_TRUE(borders) << borders.error().message;
    EXPECT_EQ(borders->pictures, before->images.size());
    EXPECT_EQ(borders->wrong_sizes, 0U);
    EXPECT_LT(borders->longest_blank, 0.01) << borders->blankest;
    test::expect_3dgs_opens(part);
    test::expect_gsplat_opens(part, 4);
    test::expect_nerfstudio_opens(part, {1, 2, 4});
    test::expect_opensplat_opens(part);
    test::expect_brush_opens(part);
    test::expect_lichtfeld_opens(part);
    test::expect_openmvs_opens(part);
    test::expect_colmap_stereo_opens(part);
    const auto written = times_in("data");
    ASSERT_EQ(test::psfm_command(dataset), 0);
    EXPECT_EQ(times_in("data"), written) << "a second run has nothing to write";
}

INSTANTIATE_TEST_SUITE_P(Scenes, DatasetReal, testing::Values("real/kitchen", "real/brighton"),
                         [](const auto& scene) {
                             return fs::path(scene.param).filename().string();
                         });

}  // namespace
}  // namespace psfm
